"""Sweeps in real processes: the same answers for any number of workers, nothing done twice, nothing lost to another's failure."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from jobs.crew import Hands, processes
from jobs.job import Done, Job
from jobs.keep import Answers
from jobs.run import run
from tests.jobs import doing
from tests.soak import SOAK, sampled
from tests.test_project import ROOT

PATIENCE_S = 120.0  # only ends a test that has hung


@contextmanager
def here() -> Iterator[Hands]:
    """The same through threads of this process, where nothing is asked of processes."""
    with ThreadPoolExecutor(2) as pool:
        yield Hands(pool, 2)


def swept(function: Callable[[Any], Any], records: Iterable[Any], folder: Path, crew: Any = here) -> list[Done]:
    jobs = (Job(f"job {index}", function, record) for index, record in enumerate(records))
    return list(run(jobs, crew, Answers(folder)))


def test_one_worker_and_more_give_the_same_bytes(tmp_path: Path) -> None:
    answers = []
    for workers in (1, 2, 3) if SOAK else (1, 2):
        records = [doing.Throw(7, index) for index in range(7)]
        done = swept(doing.thrown, records, tmp_path / str(workers), processes(workers))
        assert [entry.name for entry in done] == [f"job {index}" for index in range(7)]
        answers.append([entry.answer for entry in done])
    assert answers.count(answers[0]) == len(answers)
    assert len({entry["sum"] for entry in answers[0]}) == 7
    assert {entry["threads"] for entry in answers[0]} == {1}


def test_answers_come_in_the_order_of_the_jobs_whichever_is_done_first(tmp_path: Path) -> None:
    assert [entry.answer for entry in swept(doing.late, range(5), tmp_path)] == list(range(5))


def test_what_is_kept_is_not_done_again_and_a_changed_record_is(tmp_path: Path) -> None:
    first = swept(doing.thrown, [doing.Throw(1, 0), doing.Throw(1, 1)], tmp_path)
    again = swept(doing.thrown, [doing.Throw(1, 1), doing.Throw(1, 0), doing.Throw(2, 0)], tmp_path)
    assert [entry.kept for entry in first] == [False, False]
    assert [entry.kept for entry in again] == [True, True, False]
    assert again[0].answer == first[1].answer
    assert again[2].answer != first[0].answer


def test_half_a_kept_answer_is_done_again(tmp_path: Path) -> None:
    first = swept(doing.thrown, [doing.Throw(1, 0)], tmp_path)
    kept = next(tmp_path.glob("*.json"))
    kept.write_text(kept.read_text()[:20])
    again = swept(doing.thrown, [doing.Throw(1, 0)], tmp_path)
    assert not again[0].kept
    assert again[0].answer == first[0].answer


def test_a_job_that_fails_names_its_record_and_the_others_go_on(tmp_path: Path) -> None:
    done = swept(doing.odd_fails, range(7), tmp_path)
    assert [entry.answer for entry in done] == [0, None, 2, None, 4, None, 6]
    assert done[1].failure == "record 1: number: got an odd one, expected an even one; add 1"
    assert done[5].failure is not None
    assert done[5].failure.startswith("ZeroDivisionError: five (tests/jobs/doing.py:")
    assert len(list(tmp_path.glob("*.json"))) == 4


def test_an_answer_that_cannot_be_kept_is_a_failure(tmp_path: Path) -> None:
    assert "not JSON serializable" in str(swept(doing.no_json, [0], tmp_path)[0].failure)


def test_a_dead_worker_costs_the_job_that_killed_it_and_no_other(tmp_path: Path) -> None:
    culprit = 3
    marks = tmp_path / "marks"
    marks.mkdir()
    records = [(index, culprit, str(marks)) for index in range(6)]
    done = swept(doing.deadly, records, tmp_path / "kept", processes(2))
    assert [entry.answer for entry in done] == [0, 1, 2, None, 4, 5]
    assert "the worker process died" in str(done[culprit].failure)
    assert [entry.failure for entry in done].count(None) == 5


PROGRAM = """
import sys
from pathlib import Path
from jobs.crew import processes
from jobs.job import Job
from jobs.keep import Answers
from jobs.run import run
from tests.jobs.doing import two_then_endless

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    jobs = [Job(str(index), two_then_endless, (index, sys.argv[1])) for index in range(6)]
    try:
        for done in run(jobs, processes(2), Answers(folder / "kept")):
            print(done.name, flush=True)
    except KeyboardInterrupt:
        print("interrupted")
"""


def begun(folder: Path, suffix: str, count: int) -> set[str]:
    """The workers that say so, waited for."""
    until = time.monotonic() + PATIENCE_S
    while len(found := {path.name.partition("-")[2] for path in folder.glob(f"{suffix}-*")}) < count:
        assert time.monotonic() < until
        time.sleep(0.05)
    return found


def alive(worker: str) -> bool:
    """Whether a process runs, and is not merely waiting to be noticed."""
    try:
        return Path(f"/proc/{worker}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


# How it is ended, and whether its workers are told as well.
ENDED = [(signal.SIGINT, True), (signal.SIGINT, False), (signal.SIGKILL, False)]


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs /proc to see processes")
@pytest.mark.parametrize(("sign", "to_all"), sampled(ENDED, keep=ENDED[:1]))
def test_ended_in_the_middle_it_keeps_what_is_done_and_leaves_no_process(
    tmp_path: Path, sign: signal.Signals, to_all: bool
) -> None:
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, str(program), str(tmp_path)]
    process = subprocess.Popen(
        command,
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's background jobs do not hear it
    )
    assert process.stdout is not None
    said = process.stdout.readline() + process.stdout.readline()
    workers = begun(tmp_path, "begun", 2)
    if to_all:
        os.killpg(process.pid, sign)  # as a terminal does
    else:
        process.send_signal(sign)
    said += process.communicate(timeout=PATIENCE_S)[0]
    assert said == ("0\n1\n" if sign == signal.SIGKILL else "0\n1\ninterrupted\n")
    assert len(list((tmp_path / "kept").glob("*.json"))) == 2
    until = time.monotonic() + PATIENCE_S
    while any(map(alive, workers)):
        assert time.monotonic() < until
        time.sleep(0.05)
    if sign == signal.SIGINT:
        assert begun(tmp_path, "closed", 2) == workers


def test_without_the_extra_one_line_says_how_to_get_it() -> None:
    program = (
        "import sys; sys.modules['distributed'] = None\n"
        "from jobs.crew import cluster\n"
        "with cluster('tcp://127.0.0.1:9')(): pass"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True)
    assert "no library distributed, expected the extra `cluster`; pip install" in done.stderr.splitlines()[-1]
