"""The same jobs on a Dask cluster of this computer: the same bytes, and a clear line where the cluster cannot do them."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from jobs.crew import cluster, processes
from jobs.job import Done, Job
from jobs.keep import Answers
from jobs.run import DIED, run
from records.errors import BadInput
from tests.jobs import doing
from tests.test_project import ROOT

distributed: Any = pytest.importorskip("distributed", reason="no Dask: pip install --editable '.[cluster]'")


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Two workers of one thread each, in processes of their own, on loopback."""
    folder = str(tmp_path_factory.mktemp("dask"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=":0", local_directory=folder
        ) as local:
            yield local.scheduler_address


def swept(function: Any, records: list[Any], folder: Path, crew: Any) -> list[Done]:
    jobs = [Job(f"job {index}", function, record) for index, record in enumerate(records)]
    return list(run(jobs, crew, Answers(folder)))


def test_a_cluster_gives_the_bytes_of_a_process(address: str, tmp_path: Path) -> None:
    records = [doing.Throw(7, index) for index in range(5)]
    there = swept(doing.thrown, records, tmp_path / "there", cluster(address))
    alone = swept(doing.thrown, records, tmp_path / "alone", processes(1))
    assert [entry.answer for entry in there] == [entry.answer for entry in alone]
    again = swept(doing.thrown, records, tmp_path / "there", cluster(address))
    assert all(entry.kept for entry in again)


def test_a_failure_there_names_its_record_and_the_others_go_on(address: str, tmp_path: Path) -> None:
    done = swept(doing.odd_fails, list(range(4)), tmp_path, cluster(address))
    assert [entry.answer for entry in done] == [0, None, 2, None]
    assert "record 3: number" in str(done[3].failure)


def test_a_worker_that_dies_costs_the_job_that_killed_it_and_no_other(address: str, tmp_path: Path) -> None:
    culprit, marks = 2, tmp_path / "marks"
    marks.mkdir()
    records = [(index, culprit, str(marks)) for index in range(4)]
    done = swept(doing.deadly, records, tmp_path / "kept", cluster(address))
    assert [entry.answer for entry in done] == [0, 1, None, 3]
    assert "the worker process died" in str(done[culprit].failure)


@contextmanager
def lone_worker(folder: Path, nanny: str) -> Iterator[str]:
    """The address of a scheduler with one worker of one thread, as `dask worker` begins it, with or without its nanny."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with distributed.LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=":0") as local:
        command = [sys.executable, "-m", "distributed.cli.dask_worker", local.scheduler_address]
        options = [nanny, "--no-dashboard", "--nthreads", "1", "--local-directory", str(folder)]
        with subprocess.Popen([*command, *options], env=environment, stderr=subprocess.DEVNULL) as worker:
            with distributed.Client(local.scheduler_address, set_as_default=False) as client:
                client.wait_for_workers(1)
            try:
                yield local.scheduler_address
            finally:
                worker.kill()  # a nanny that is asked may first wait for a worker that is only beginning


def test_a_cluster_whose_last_worker_died_is_told_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("jobs.run.LOOK_s", 0.5)
    records = [(index, 1, str(tmp_path)) for index in range(2)]
    with (
        lone_worker(tmp_path, "--no-nanny") as address,
        pytest.raises(BadInput, match="Dask cluster: got its last worker gone"),
    ):
        swept(doing.deadly, records, tmp_path / "kept", cluster(address))


def test_a_worker_that_its_nanny_replaces_is_waited_for_however_often_it_is_looked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # While the nanny begins the next worker there is none, for seconds, and it is looked all the time. As Dask has nobody else to
    # try the jobs with, both are suspected; the second is innocent.
    monkeypatch.setattr("jobs.run.LOOK_s", 0.01)
    records = [(index, 0, str(tmp_path)) for index in range(2)]
    with lone_worker(tmp_path, "--nanny") as address:
        done = swept(doing.deadly, records, tmp_path / "kept", cluster(address))
    assert [(entry.answer, entry.failure) for entry in done] == [(None, DIED), (1, None)]


def test_workers_with_other_sources_are_refused_by_name(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("jobs.crew.code_digest", other_sources)
    with pytest.raises(BadInput, match=r"tcp://127\.0\.0\.1:\d+: Dask workers: got other sources"):
        swept(doing.late, [0], tmp_path, cluster(address))


def other_sources() -> str:
    """Of this process; a worker computes its own, which imports nothing of this test."""
    return f"of process {os.getpid()}"


def test_a_scheduler_without_workers_and_none_at_all_are_told_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (
        distributed.LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=":0") as local,
        pytest.raises(BadInput, match="Dask workers: got none, expected at least one"),
    ):
        swept(doing.late, [0], tmp_path, cluster(local.scheduler_address))
    monkeypatch.setattr("jobs.crew.PATIENCE_S", 0.5)
    with pytest.raises(BadInput, match=r"Dask scheduler: got .*expected one that answers"):
        swept(doing.late, [0], tmp_path, cluster("tcp://127.0.0.1:9"))
