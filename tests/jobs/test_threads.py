"""Processes and their threads together are no more than processors."""

import os

import pytest

from jobs.threads import cores, one_thread_each, threads


def test_processors_are_not_asked_for_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker's own threads are one, whatever the number of processors."""
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    assert threads() == cores() >= 1
    with one_thread_each():
        assert threads() == 1
        assert os.environ["OPENBLAS_NUM_THREADS"] == "1"
    assert "OMP_NUM_THREADS" not in os.environ
