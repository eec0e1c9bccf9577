"""Where a reading changes by one count: the output has just passed the edge between both, which tells more than the count itself."""

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions

Array = NDArray[np.float64]


def sharpened(t_s: Array, y: Array, r: Array, step: float) -> tuple[Array, Array]:
    """Readings y (n,) on a grid of `step` and their variances r, as what they say of the output.

    An output that passed the edge e between two counts within the last row, of length h, with speed v, is found at

    (1)  y = e + v h / 2,  variance travel^2 / 12,  travel = step h / T,

    v that of the parabola through this edge and those passed before and after, T the shorter of the times since and until.

    Noise makes counts change to and fro beside an edge, so that none of them tells when it was passed: where more than UNDONE_SHARE of all
    changes are undone within UNDONE_ROWS, readings stay what they were.
    """
    seen = np.flatnonzero(np.isfinite(y))
    moved = np.diff(y[seen])
    after = np.flatnonzero(moved) + 1
    if step <= 0.0 or len(after) < 2 or _undone(after, np.sign(moved[after - 1])) > decisions.UNDONE_SHARE:
        return y, r
    rows, before = seen[after], seen[after - 1]
    edge, moved = 0.5 * (y[rows] + y[before]), moved[after - 1]
    h, lasts = t_s[rows] - t_s[before], np.diff(t_s[rows])
    travel = step * h / _shorter(lasts, np.sign(moved))
    one_row = h < decisions.MORE_THAN_ONE * float(np.median(np.diff(t_s[seen])))
    sharp = (np.abs(moved) < decisions.MORE_THAN_ONE * step) & one_row & (travel < decisions.SLOW_COUNTS * step)
    forward = np.clip(_speed(lasts, np.diff(edge)) * h * np.sign(moved), 0.0, travel)
    found_y, found_r = y.copy(), r.copy()
    found_y[rows[sharp]] = (edge + 0.5 * forward * np.sign(moved))[sharp]
    found_r[rows[sharp]] = np.minimum(travel[sharp] ** 2 / 12.0, r[rows[sharp]])
    return found_y, found_r


def _undone(after: NDArray[np.int64], signs: Array) -> float:
    """Which share of the changes at rows `after` (k,) go back within UNDONE_ROWS."""
    return float(np.mean((np.diff(after) <= decisions.UNDONE_ROWS) & (signs[1:] != signs[:-1])))


def _shorter(lasts: Array, signs: Array) -> Array:
    """The shorter of the times (k,) beside each change, `lasts` (k - 1,) between them; a count left where it was entered lasts less."""
    lasts = np.where(signs[1:] != signs[:-1], lasts / decisions.TURNED, lasts)
    return np.asarray(np.minimum(np.append(np.inf, lasts), np.append(lasts, np.inf)))


def _speed(lasts: Array, ways: Array) -> Array:
    """The speed (k,) at each of k points, `ways` and `lasts` (k - 1,) apart, of the parabola through it and its neighbours."""
    mean: Array = np.asarray(ways / lasts)
    inner = (mean[:-1] * lasts[1:] + mean[1:] * lasts[:-1]) / (lasts[:-1] + lasts[1:])
    return np.asarray(np.concatenate([mean[:1], inner, mean[-1:]]))
