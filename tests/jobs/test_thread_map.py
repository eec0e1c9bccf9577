"""Pieces of work side by side give what they give one after the other, however they nest."""

import threading

import pytest

from jobs.thread_map import WORKERS, thread_map


def test_answers_come_in_the_order_of_the_items() -> None:
    assert thread_map(lambda one, other: one - other, range(40), range(0, 80, 2)) == [-place for place in range(40)]
    assert thread_map(abs, []) == []


def test_pieces_that_ask_again_end() -> None:
    """More pieces than workers, each with pieces of its own, three deep: none may wait for one that waits for it."""

    def sum_below(depth: int) -> int:
        return 1 if depth == 0 else sum(thread_map(sum_below, [depth - 1] * (WORKERS + 1)))

    assert thread_map(sum_below, [3] * (2 * WORKERS)) == [(WORKERS + 1) ** 3] * (2 * WORKERS)


def test_pieces_run_at_the_same_time() -> None:
    """Each piece ends only when all are running."""
    together = threading.Barrier(WORKERS, timeout=60.0)
    assert len(thread_map(lambda _: together.wait(), range(WORKERS))) == WORKERS


def test_what_a_piece_raises_is_raised() -> None:
    with pytest.raises(ZeroDivisionError):
        thread_map(lambda value: thread_map(lambda small: 1 // small, [1, value]), [1, 0])
    with pytest.raises(ValueError, match="shorter"):
        thread_map(lambda one, other: one, [1, 2], [1])
