"""Where a reading changes by one count: the output has just passed the edge between both, which tells more than the count itself."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ONE_COUNT = 1.5  # counts, and rows: what is beyond is no single count, or has rows missing
SLOW = 0.5  # counts from row to row; of faster motion an edge tells no more than the count
UNDONE_ROWS, UNDONE = (
    3,
    0.05,
)  # a count so short that ends as it began is noise's, and so large a share of all changes tells of it
TURNED = 2.0  # how much faster than on average over a count an output passes the edge at which it came and goes


def sharpened(t_s: Array, y: Array, r: Array, step: float) -> tuple[Array, Array]:
    """Readings y (n,) on a grid of `step` and their variances r, as what they say of the output.

    An output that lies within one count for the time T moves with step / T or less, so one that passed the edge e between two
    counts during the last row, of length h, is found at

    (1)  y = e +- travel / 2,  variance travel^2 / 12,  travel = step h / T,  T the shorter of the counts before and after.

    Noise makes counts change to and fro beside an edge, so that none of them tells when it was passed: where more than UNDONE of all
    changes are undone within UNDONE_ROWS, readings stay what they were.
    """
    seen = np.flatnonzero(np.isfinite(y))
    moved = np.diff(y[seen])
    after = np.flatnonzero(moved) + 1
    if step <= 0.0 or len(after) < 2 or _undone(after, np.sign(moved[after - 1])) > UNDONE:
        return y, r
    h = np.diff(t_s[seen])
    travel = step * h[after - 1] / _shorter(t_s[seen[after]], np.sign(moved[after - 1]))
    one = np.abs(moved[after - 1]) < ONE_COUNT * step
    sharp = one & (travel < SLOW * step) & (h[after - 1] < ONE_COUNT * float(np.median(h)))
    rows, before = seen[after[sharp]], seen[after[sharp] - 1]
    edge = 0.5 * (y[rows] + y[before])
    found_y, found_r = y.copy(), r.copy()
    found_y[rows] = edge + 0.5 * travel[sharp] * np.sign(y[rows] - y[before])
    found_r[rows] = np.minimum(travel[sharp] ** 2 / 12.0, r[rows])
    return found_y, found_r


def _undone(after: NDArray[np.int64], signs: Array) -> float:
    """Which share of the changes at rows `after` (k,) go back within UNDONE_ROWS."""
    return float(np.mean((np.diff(after) <= UNDONE_ROWS) & (signs[1:] != signs[:-1])))


def _shorter(t_s: Array, signs: Array) -> Array:
    """How long the shorter of the counts beside each change (k,) lasts; one that is left where it was entered counts as shorter."""
    lasts = np.diff(t_s)
    lasts = np.where(signs[1:] != signs[:-1], lasts / TURNED, lasts)
    return np.asarray(np.minimum(np.append(np.inf, lasts), np.append(lasts, np.inf)))
