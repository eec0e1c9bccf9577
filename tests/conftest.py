"""What all tests share: one thread for linear algebra, as for `twinlaw` itself, no soaks unasked, one run of the chain, a short search."""

import fcntl
import gc
import os
import sys
from collections.abc import Generator
from pathlib import Path
from typing import TextIO

import pytest

import twinlaw as twinlaw  # before NumPy, whose threads it counts
from tests.soak import SOAK
from toolchain.cache import CACHE_DIR

# As in the Makefile, for who calls pytest itself: else both workers and every process that a test starts compile what they import anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False


@pytest.fixture(scope="session")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """What `make run` leaves, by one process for all tests and all workers of pytest, and what it prints. Nobody may write into it."""
    from tests.docs.reading import readme  # which needs all of twinlaw, where many tests need little

    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    folder, printed = shared / "ran", shared / "ran.txt"
    with (shared / "ran.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not printed.exists():
            printed.write_text(readme.told(folder), encoding="utf-8")
    return folder, printed.read_text(encoding="utf-8")


@pytest.fixture
def one_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """A search for another firmware tries one change at a time: its thousands of pairs are nearly all of its time. They are tried in a
    soak, and by those tests of the replay that do not ask for this."""
    if not SOAK:
        monkeypatch.setattr("replay.search._pairs", lambda single: ())


def draws_nothing(patch: pytest.MonkeyPatch) -> None:
    """Pictures are blank from now on, but in a soak: to write them takes most of the time of a report."""

    class Blank:
        def __init__(self, figure: object) -> None:
            self.figure = figure

        def print_svg(self, stream: TextIO, metadata: object) -> None:
            stream.write("<svg></svg>")

    if not SOAK:
        patch.setattr("twinlaw.pages.plots.FigureCanvasSVG", Blank)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """A test that asks for no picture gets blank ones."""
    draws_nothing(monkeypatch)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """In a fresh checkout one worker imports everything after the other: the first compiles it, the second finds it compiled."""
    gc.disable()
    compiled = CACHE_DIR / "compiled"
    if "PYTEST_XDIST_WORKER" not in os.environ or compiled.exists():
        return (yield)
    CACHE_DIR.mkdir(parents=True, exist_ok=True)
    with (CACHE_DIR / "compiled.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        found = yield
        compiled.touch()
        return found


def pytest_collection_finish() -> None:
    """All that was imported stays until the end: who looks for rubbish need not walk through it, not even once."""
    gc.freeze()
    gc.set_threshold(20_000)  # objects, where 700 are usual: equations are trees of many small ones
    gc.enable()


def pytest_sessionfinish() -> None:
    """What is left ends with the process: pytest would look through all of it once more for a warning."""
    gc.freeze()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is marked as a soak, unless TWINLAW_SOAK=1 asks for it."""
    if SOAK:
        return
    soaks = [item for item in items if item.get_closest_marker("soak")]
    if soaks:
        config.hook.pytest_deselected(items=soaks)
        items[:] = [item for item in items if item not in set(soaks)]
