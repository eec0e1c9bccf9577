"""Rows of a file in which nothing stands but their time: empty cells, or the zeros of a record that was never filled in."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

USUAL_PERCENT = 99.0  # percentile of an output's moves from row to row
LEAP = 5.0  # times that: no motion goes so far to zero and back
LEAP_STEPS = 20.0  # times the least move, the same on a coarse grid
MOST = 0.1  # of a log's rows: a plant that stands at zero in more of them is switched


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
    place = np.searchsorted(written, np.arange(len(y)))
    before, after = (written[np.clip(place - back, 0, written.size - 1)] for back in (1, 0))
    inside = (place > 0) & (place < written.size)
    driven = zero & inside & ((u[before] != 0.0) & (u[after] != 0.0)).any(axis=1)
    leaps = [driven & _leaps(column, written, before, after) for column in y.T]
    return empty | driven if np.any(leaps) and driven.mean() <= MOST else empty


def _leaps(values: Array, written: NDArray[np.intp], before: NDArray[np.intp], after: NDArray[np.intp]) -> Rows:
    """Rows (n,) between two readings from which the output goes to zero in no usual move."""
    read = values[written]
    moves = np.abs(np.diff(read[np.isfinite(read)]))
    if not moves.any():
        return np.asarray(np.fmin(np.abs(values[before]), np.abs(values[after])) > 0.0)
    usual, least = float(np.percentile(moves, USUAL_PERCENT)), float(moves[moves > 0.0].min())
    return np.asarray(np.fmin(np.abs(values[before]), np.abs(values[after])) > max(LEAP * usual, LEAP_STEPS * least))
