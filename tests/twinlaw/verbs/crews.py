"""A crew that works in the test's own process: what a verb makes of its jobs' answers needs no process that loads all anew."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest

from jobs.crew import Hands
from twinlaw.workflows import sweeping


@contextmanager
def _in_a_thread() -> Iterator[Hands]:
    with ThreadPoolExecutor(1) as executor:
        yield Hands(executor, 1)


def works_here(patch: pytest.MonkeyPatch) -> None:
    """From now on every sweep does its jobs one after the other in a thread, as `--workers` and `--cluster` do them elsewhere."""
    patch.setattr(sweeping, "crew_of", lambda chosen: _in_a_thread)
