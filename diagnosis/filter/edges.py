"""Where a reading changes by one count: the output has just passed the edge between both, which tells more than the count itself."""

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions

Array = NDArray[np.float64]


def sharpened(t_s: Array, y: Array, r: Array, step: float) -> tuple[Array, Array]:
    """Readings y (n,) on a grid of `step` and their variances r, as what they say of the output.

    An output that passed the edge e between two counts within the last row, of length h, with speed v, is found at

    (1)  y = e + v h / 2,  variance travel^2 / 12,  travel = step h / T,

    v that of the parabola through this edge and those passed before and after, T the shorter of the times since and until. A count left
    where it was entered, after T, was passed half on average by a parabola, which crosses the edge twice as fast:

    (2)  depth = v T / 4 = step / 2,  travel = v h = 2 step h / T

    Of an output that travels more than SLOW_COUNTS in a row T is too few rows to tell that. Noise makes counts change to and fro beside an
    edge, so that none of them tells when it was passed: where that is the likelier reason, readings stay what they were.
    """
    if noise_moves_counts(t_s, y, step):
        return y, r
    seen = np.flatnonzero(np.isfinite(y))
    moved = np.diff(y[seen])
    after = np.flatnonzero(moved) + 1
    if step <= 0.0 or len(after) < 2:
        return y, r
    rows, before = seen[after], seen[after - 1]
    edge, moved = 0.5 * (y[rows] + y[before]), moved[after - 1]
    h, lasts, signs = t_s[rows] - t_s[before], np.diff(t_s[rows]), np.sign(moved)
    row = float(np.median(np.diff(t_s[seen])))
    travel = step * h / _shorter(lasts, signs)
    one_row = h < decisions.MORE_THAN_ONE * row
    sharp = (np.abs(moved) < decisions.MORE_THAN_ONE * step) & one_row & (travel < decisions.SLOW_COUNTS * step)
    forward = np.clip(_speed(lasts, np.diff(edge)) * h * signs, 0.0, travel)
    found_y, found_r = y.copy(), r.copy()
    found_y[rows[sharp]] = (edge + 0.5 * forward * signs)[sharp]
    found_r[rows[sharp]] = np.minimum(travel[sharp] ** 2 / 12.0, r[rows[sharp]])
    return found_y, found_r


def noise_moves_counts(t_s: Array, y: Array, step: float) -> bool:
    """Whether noise is the likelier reason why readings (n,) on a grid of `step` leave counts again where they entered them."""
    t_s, y = t_s[np.isfinite(y)], y[np.isfinite(y)]
    after = np.flatnonzero(np.diff(y)) + 1
    if step <= 0.0 or len(after) < 2:
        return False
    return _undone(np.diff(t_s[after]) / float(np.median(np.diff(t_s))), np.sign(np.diff(y)[after - 1]))


def _undone(lasts: Array, signs: Array) -> bool:
    """Whether noise is the likelier reason why counts are left where they were entered, by their lengths in rows `lasts` (k - 1,) and the
    ways of the k changes.

    One is undone where it lasts two rows at most, a travel of a step a row by (2). Noise undoes it as likely as not. A parabola that takes
    b rows over the count before, and turns anywhere in this one, does with probability

    (3)  p = q^2 / (1 - q^2),  q = 1 / (1 + b)
    """
    turned = np.flatnonzero(signs[1:] != signs[:-1])
    turned = turned[turned > 0]
    q = 1.0 / (1.0 + np.maximum(lasts[turned - 1], 1.0))
    p = q**2 / (1.0 - q**2)
    undone = np.round(lasts[turned]) <= 2.0
    return bool(np.sum(np.where(undone, np.log(0.5 / p), np.log(0.5 / (1.0 - p)))) > 0.0)


def _shorter(lasts: Array, signs: Array) -> Array:
    """The shorter T (k,) of the times beside each change, `lasts` (k - 1,) between them, half of one by (2)."""
    lasts = np.where(signs[1:] != signs[:-1], lasts / 2.0, lasts)
    return np.asarray(np.minimum(np.append(np.inf, lasts), np.append(lasts, np.inf)))


def _speed(lasts: Array, ways: Array) -> Array:
    """The speed (k,) at each of k points, `ways` and `lasts` (k - 1,) apart, of the parabola through it and its neighbours."""
    mean: Array = np.asarray(ways / lasts)
    inner = (mean[:-1] * lasts[1:] + mean[1:] * lasts[:-1]) / (lasts[:-1] + lasts[1:])
    return np.asarray(np.concatenate([mean[:1], inner, mean[-1:]]))
