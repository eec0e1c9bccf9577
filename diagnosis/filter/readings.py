"""What each reading of an output says: its count or the edge that it passed, how unsure that is, and with how many others it shares its
rounding.

An encoder's error is its rounding, of variance step^2 / 12, the same as long as the count is, and noise, new with each reading:

(1)  r = single + (n - 1) step^2 / 12

for each of n readings of one count, together known as well as their mean is. Noise carries readings to the next count and back. Where it
came before the rounding, of an axis near the edge between both, that dithers it: runs of a count are short, and their mean tells where the
axis is. Noise that came behind a rounding moves the count of an axis at rest to both sides alike, and leaves it as it was: then all that
stay about one mean share it.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.edges import noise_moves_counts, sharpened

Array = NDArray[np.float64]
DIFFERENCES = (
    (2, 6.0),
    (4, 70.0),
)  # order, and by how much it makes white noise's variance larger: the sum of squared binomials
ABOUT = 1.25  # steps: a count to either side of one, and no two
LONG_ROWS = 30  # of stretches that show which side is the rarer
TO_BOTH_SIDES = 0.2  # of the rarer side beside the other: simulated rests of 30 to 200 rows have 0.17 at most before, 0.18 to 0.74 behind
LARGE_NOISE = 0.5  # steps, from where on noise moves counts to both sides wherever it comes


@dataclass(frozen=True, eq=False)
class Readings:
    """Of one output: `y` (n,) with variances `r` (n,), `standing` (n,) the readings that are worth one, by (1), and the variance of a
    `single` one."""

    y: Array
    r: Array
    standing: Array
    single: float


def readings_of(t_s: Array, read: Array, used: NDArray[np.bool_], step: float, stated: float) -> Readings:
    """What is known of readings (n,), NaN where there is none, by the variance that is `stated`, that of step and noise, or by what they
    show. Those that are not `used` tell how noise moves the others, and nothing else."""
    told, rounding = np.where(used, read, np.nan), step**2 / 12.0
    alike = _of_one_rounding(read, step) if noise_moves_counts(t_s, read, step) else None
    single = _variance(read, step, stated, alike is not None)
    if alike is not None and single - rounding < (LARGE_NOISE * step) ** 2:
        standing = 1.0 + (alike - 1.0) * rounding / single
        return Readings(told, standing * single, standing, single)
    standing = _of_one_count(read)
    if single > rounding:  # with noise a reading is carried over an edge and back: the edge tells nothing
        return Readings(told, standing * single, standing, single)
    y, r = sharpened(t_s, told, standing * single, step)
    return Readings(y, r, standing, single)


def _of_one_count(y: Array) -> Array:
    """How many readings each is one of that are the same, one after another: what is read again and again says no more than once."""
    count = np.ones(len(y))
    seen = np.flatnonzero(np.isfinite(y))
    if len(seen):
        count[seen] = _lengths(np.append(0, np.cumsum(np.diff(y[seen]) != 0.0)))
    return count


def _of_one_rounding(y: Array, step: float) -> Array | None:
    """The same of readings that noise behind a rounding moves: those of a stretch that stays about its mean, or of a step's way where it
    moves by more. None where the noise came before."""
    count, seen = np.ones(len(y)), np.isfinite(y)
    stretch = _stretches(y[seen], ABOUT * step)
    if not _to_both_sides(np.round(y[seen] / step), stretch):
        return None
    count[seen] = np.maximum(1.0, _lengths(stretch) / np.maximum(1.0, _ways(y[seen], stretch) / step))
    return count


def _to_both_sides(counts: Array, number: NDArray[np.int64]) -> bool:
    """Whether the counts of long stretches leave the one that they are mostly at to both sides alike."""
    rarer = other = 0
    for begin, end in pairwise([*np.flatnonzero(np.diff(number, prepend=-1)).tolist(), len(number)]):
        if end - begin >= LONG_ROWS:
            mostly = np.median(counts[begin:end])
            sides = sorted((int(np.sum(counts[begin:end] < mostly)), int(np.sum(counts[begin:end] > mostly))))
            rarer, other = rarer + sides[0], other + sides[1]
    return rarer > TO_BOTH_SIDES * other


def _lengths(number: NDArray[np.int64]) -> Array:
    return np.bincount(number)[number].astype(float)


def _stretches(y: Array, about: float) -> NDArray[np.int64]:
    """The number of each reading's stretch (n,), which ends before the first reading that is not `about` the mean of those before it."""
    begins = np.zeros(len(y), dtype=np.int64)
    total, count = 0.0, 0
    for row, value in enumerate(y.tolist()):
        if count and abs(value - total / count) > about:
            begins[row], total, count = 1, 0.0, 0
        total, count = total + value, count + 1
    return np.cumsum(begins)


def _ways(y: Array, number: NDArray[np.int64]) -> Array:
    """How far each reading's stretch (n,) moves: as a steady motion whose halves have means so far apart."""
    place = np.arange(len(y)) - np.searchsorted(number, number)
    late = place >= 0.5 * _lengths(number)
    halves = [_means(y, number, half) for half in (late, ~late)]
    return np.asarray(2.0 * np.abs(halves[0] - halves[1]))[number]


def _means(y: Array, number: NDArray[np.int64], of: NDArray[np.bool_]) -> Array:
    """The mean of some of the readings of each stretch; that of all where there are none."""
    stretches = int(number[-1]) + 1
    count, total = (np.bincount(number[of], w, stretches) for w in (None, y[of]))
    whole = np.bincount(number, y, stretches) / np.bincount(number)
    return np.where(count > 0, total / np.maximum(count, 1), whole)


def _variance(y: Array, step: float, stated: float, behind: bool) -> float:
    """Variance of a measurement: that of its encoder's step and noise, or what its differences show where that is clearly more.

    White noise of variance r leaves second differences of 6 r and fourth ones of 70 r; the smaller says more, as motion adds to both.
    Rounding leaves 6 step^2 / 12 on average, and twice as much of a steady motion that it rounds up and down in turns: what is more is
    noise, and all of it where that comes behind a rounding. What is far beyond the usual is left out. Where no step is stated the
    readings' own counts: a speed that is logged in whole counts mostly stands still, but is not exact for that.
    """
    seen = min(_scatter(y, order, times, step) for order, times in DIFFERENCES)
    if not step:
        return max(stated + _finest(y) ** 2 / 12.0, seen, 1e-18)
    least = stated if behind else stated + step**2 / 12.0
    return min(seen, 100.0 * stated) if seen > least else stated


def _scatter(y: Array, order: int, times: float, step: float) -> float:
    """The variance of white noise that leaves such differences of an order, in which it is `times` as large; 0 of too few readings."""
    change = np.abs(np.diff(y[np.isfinite(y)], order))
    if not change.size:
        return 0.0
    usual = max(1.4826 * float(np.median(change)), step)
    return (
        float(np.mean(np.minimum(change, decisions.BEYOND_CHANCE * usual) ** 2)) / times if step else usual**2 / times
    )


def _finest(y: Array) -> float:
    """The smallest difference between any two readings that differ, 0 where none do."""
    gaps = np.diff(np.unique(y[np.isfinite(y)]))
    return float(gaps.min()) if gaps.size else 0.0
