"""Processes and their threads together are no more than processors."""

import ctypes
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import scipy.linalg

from jobs.threads import COUNTS, cores, one_thread_each, threads
from tests.test_project import ROOT


def test_processors_are_not_asked_for_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker's own threads are one, whatever the number of processors."""
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    assert threads() == cores() >= 1
    with one_thread_each():
        assert threads() == 1
        assert os.environ["OPENBLAS_NUM_THREADS"] == "1"
    assert "OMP_NUM_THREADS" not in os.environ


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="only here does a process tell what it has loaded")
def test_the_linear_algebra_of_these_tests_has_one_thread_as_that_of_the_commands_has() -> None:
    """NumPy's and SciPy's OpenBLAS in this process, unless the environment asks for more: with two, small matrices took 30 times longer."""
    assert scipy.linalg.norm([3.0, 4.0]) == 5.0  # it is loaded
    libraries = set(re.findall(r"/\S+openblas\S+", Path("/proc/self/maps").read_text()))
    counts = {path: _openblas_threads(ctypes.CDLL(path)) for path in libraries}
    assert all(count in (int(os.environ.get("OPENBLAS_NUM_THREADS", "1")), None) for count in counts.values()), counts


SEEN_BY_A_VERB = """
import numpy
from threadpoolctl import threadpool_info
from twinlaw.command import main
from twinlaw.verbs import doctor

def counts(*_):
    print([pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"])
    return 0

counts()
doctor.run = counts
main(["doctor"])
counts()
"""


@pytest.mark.skipif(cores() < 2, reason="one processor: OpenBLAS never takes two threads there")
def test_a_command_that_a_notebook_gives_has_one_thread_too_and_gives_the_others_back() -> None:
    """NumPy is loaded before us there, with a thread a processor (two here, however many there are)."""
    given = {name: value for name, value in os.environ.items() if name not in COUNTS} | {"GOTO_NUM_THREADS": "2"}
    done = subprocess.run([sys.executable, "-c", SEEN_BY_A_VERB], capture_output=True, text=True, env=given, cwd=ROOT)
    assert done.stdout.splitlines() == ["[2]", "[1]", "[2]"], done.stderr


def _openblas_threads(library: ctypes.CDLL) -> int | None:
    """None where its builder gave the function another name."""
    names = (f"{first}openblas_get_num_threads{last}" for first in ("scipy_", "") for last in ("", "64_"))
    return next((getattr(library, name)() for name in names if hasattr(library, name)), None)
