"""What was never written reads empty or zero: rows of a file in which nothing stands but their time, and how far from zero a number must
be beside a zero for that to be none of its own."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.deciding import Limit

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]
Places = NDArray[np.intp]

USUAL_PERCENT = Limit(99.0, "percentile", "of moves from row to row")
LEAP = Limit(5.0, "times the usual move", "no motion goes so far to zero and back", "18 000 stands in honest logs")
LEAP_STEPS = Limit(20.0, "least moves", "on a coarse grid one least move is no leap")
MOST = Limit(0.1, "share of rows", "a plant that stands at zero in more of them is switched")


@dataclass(frozen=True)
class Unwritten:
    """Rows of a file that were left out as nothing stands in them: how many, and the first one's time."""

    rows: int
    first_s: float


def unwritten_rows(u: Array, y: Array, beside: Sequence[Array]) -> Rows:
    """Rows (n,) without any number, and those of zeros alone between rows in which inputs are not zero, where an output leaps to zero and
    back; `beside` are further columns (n,)."""
    none: Rows = np.zeros(len(y), bool)
    if not u.shape[1]:
        return none
    table = np.column_stack([u, y, *beside])
    empty: Rows = np.asarray(np.isnan(table).all(axis=1))
    zero: Rows = np.asarray(((table == 0.0) | np.isnan(table)).all(axis=1)) & ~empty & np.isfinite(u).all(axis=1)
    written = np.flatnonzero(~empty & ~zero)
    if not zero.any() or written.size < 2:
        return none if empty.all() else empty
    place, before, after = beside_rows(written, len(y))
    inside = (place > 0) & (place < written.size)
    driven = zero & inside & ((u[before] != 0.0) & (u[after] != 0.0)).any(axis=1)
    leaps = [driven & _leaps(column, written, before, after) for column in y.T]
    return empty | driven if np.any(leaps) and driven.mean() <= MOST else empty


def beside_rows(others: Places, rows: int) -> tuple[Places, Places, Places]:
    """Of each row (rows,): how many of the rows `others` lie before it, and the next of them before and behind it, at an end the last."""
    place = np.searchsorted(others, np.arange(rows))
    before, after = (others[np.clip(place - back, 0, others.size - 1)] for back in (1, 0))
    return place, before, after


def leap_of(moves: Array, least: float) -> float:
    """Farther than any usual one of the moves (n,) by size goes; `least` is the step of their grid."""
    return max(LEAP * float(np.percentile(moves, USUAL_PERCENT)), LEAP_STEPS * least)


def _leaps(values: Array, written: Places, before: Places, after: Places) -> Rows:
    """Rows (n,) between two readings from which the output goes to zero in no usual move."""
    read = values[written]
    moves = np.abs(np.diff(read[np.isfinite(read)]))
    leap = leap_of(moves, float(moves[moves > 0.0].min())) if moves.any() else 0.0
    return np.asarray(np.fmin(np.abs(values[before]), np.abs(values[after])) > leap)
