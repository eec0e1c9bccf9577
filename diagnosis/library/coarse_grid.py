"""Readings that lie on a coarser grid than their encoder's: which grid, and how unlikely that is by chance.

(1)  c f - round(c f) of a count c, its phase on a grid of 1/f counts, is even where there is no grid. On one it is that of a grid's point
     plus a noise of sd s, rounded to a count: p = (Phi((z + 1/2) / s) - Phi((z - 1/2) / s)) / f of z counts beside the point
Grids of f and 1 - f have the same phases but for their signs: what a count rounds tells them apart.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from diagnosis import decisions

Array = NDArray[np.float64]
Counts = NDArray[np.int64]
NOISES = np.geomspace(0.03, 1.0, 8)[:, None]  # of (1), in counts
STRAY = 0.01  # share of readings that may lie anywhere: a row that was put together from two
PADDED, PEAKS = 8, 6  # points of the spectrum a cycle over all counts; its highest peaks are asked
AROUND = np.linspace(-1.0, 1.0, 81)
# Time: a spectrum of all counts of a fine encoder took 24 s. Coarse grids are looked for first, in coarse units.
WINDOW = 1 << 14  # units of the widest spectrum
FINER = 4  # each unit as many of the next
FINEST = 8  # units: finer grids are looked for in the next unit, which shows their points apart
ROUNDED = 2.0  # counts that the farthest count may be beside the grid: rounding and noise leave it within one
# Of the highest peak: a slower one as high is the grid's own, as overtones without noise are as high as it. It adds one that is asked.
OVERTONE = 0.8
AS_GOOD = 1.0  # nats: frequencies that near the best are one plateau


def coarse_step(y: Array, step: float) -> float | None:
    """The step of the coarsest grid that the readings y (n,) lie on where it is coarser than `step`; None where there is none."""
    read = _counts(y, step)
    counts, times = np.unique(_passed(read), return_counts=True)
    if len(counts) == 0:
        return None
    different, span = min(len(np.unique(read)), int(times.sum())), int(np.ptp(counts)) + 1
    for unit in _units(span):
        inside = _busiest(counts, times, unit * WINDOW)
        begun = [
            _near(counts[inside], times[inside], peak, unit) for peak in _peaks(counts[inside], times[inside], unit)
        ]
        grids = {_over_all(counts, times, inside, f) for f in begun}
        if not grids:
            continue
        evidence, f = _finely(counts, times, max(grids, key=lambda f: _evidence(counts, times, f)))
        if _lies(evidence / times.sum(), different, span, f):
            return step / f
    return None


def grid_sd(y: Array, grid: float, step: float) -> float:
    """What is known of the step `grid` of the grid that readings y (n,) lie on, one standard deviation: the ends of what was read lie on it
    to the rounding of a count each, (2 / 12)^(1/2) `step` over the grid's steps between them."""
    return float(np.sqrt(2.0 / 12.0) * step / max(float(np.nanmax(y) - np.nanmin(y)) / grid, 1.0))


def grid_evidence(y: Array, grid: float, step: float) -> float:
    """Log likelihood, by (1), that changes of the readings y (n,) gain from lying on a grid instead of anywhere; 0 where they do not."""
    counts = _counts(y, step)
    counts, times = np.unique(counts[1:][np.diff(counts) != 0], return_counts=True)
    if len(counts) == 0 or grid <= decisions.MORE_THAN_ONE * step:
        return 0.0
    found = _evidence(counts, times, step / grid)
    return found if _lies(found / times.sum(), len(counts), int(np.ptp(counts)) + 1, step / grid) else 0.0


def _counts(y: Array, step: float) -> Counts:
    """The readings as counts of an encoder of this step; none of one without."""
    seen = y[np.isfinite(y)] if step > 0.0 else y[:0]
    return np.asarray(np.round(seen / step), np.int64)


def _passed(counts: Counts) -> Counts:
    """Counts that were passed: what an axis at rest reads in turns says of two counts only, however often."""
    changes = counts[np.append(True, np.diff(counts) != 0)] if len(counts) else counts
    way = np.sign(np.diff(changes))
    return np.asarray(changes[1:-1][way[1:] == way[:-1]], np.int64)


def _units(span: int) -> list[int]:
    """Units, in counts, the coarsest first: that whose window holds all of `span` counts, then finer ones, a count the last."""
    units = [1]
    while units[0] * WINDOW < span:
        units.insert(0, units[0] * FINER)
    return units


def _busiest(counts: Counts, times: Counts, reach: int) -> slice:
    """Where within such a reach of counts most readings are."""
    ends = np.searchsorted(counts, counts + reach)
    total = np.append(0, np.cumsum(times))
    first = int(np.argmax(total[ends] - total[:-1]))
    return slice(first, int(ends[first]))


def _peaks(counts: Counts, times: Counts, unit: int) -> list[float]:
    """Frequencies (1/unit) at which the spectrum of the counts is highest, with their twins where the unit is a count."""
    places = np.round(counts / unit).astype(np.int64)
    span = int(places[-1] - places[0]) + 1
    passes = np.bincount(places - places[0], weights=times, minlength=span)
    points = 1 << (PADDED * span - 1).bit_length()
    height = np.abs(np.fft.rfft(passes, points))
    slowest = int(decisions.MORE_THAN_ONE * points / span)
    height[:slowest] = 0.0  # of a single step between the extremes nobody knows that others are alike
    if unit > 1:
        height[points // FINEST :] = 0.0  # the next unit shows these better
    inner = np.flatnonzero(
        (height >= np.append(0.0, height[:-1])) & (height >= np.append(height[1:], 0.0)) & (height > 0.0)
    )
    ranked = inner[np.argsort(height[inner])[::-1]]
    # Overtones of a grid that is read without noise are as high as its own frequency, the lowest of them.
    lowest = [place for place in inner if height[place] > OVERTONE * height[ranked[0]]][:1]
    highest = np.array([*lowest, *ranked[:PEAKS]]) / points
    both = [f for peak in highest for f in (peak, 1.0 - peak)] if unit == 1 else highest.tolist()
    return [float(f) for f in both if f * decisions.MORE_THAN_ONE < 1.0]


def _near(counts: Counts, times: Counts, peak: float, unit: int) -> float:
    """The frequency (1/counts) beside a peak (1/unit) at which most of the counts are in phase."""
    near = (peak + AROUND / (PADDED * (int(np.ptp(counts)) / unit + 1))) / unit
    return float(near[np.argmax(np.abs(np.exp(2j * np.pi * np.outer(near, counts - counts[0])) @ times))])


def _over_all(counts: Counts, times: Counts, inside: slice, f: float) -> float:
    """The same frequency by least squares of whole steps, over twice as many counts each time until zero is among them, where a grid has
    a point."""
    centre = counts[inside][np.argmax(times[inside])]
    farthest = max(abs(centre), int(np.max(np.abs(counts - centre))))
    reach = int(np.ptp(counts[inside])) + 1
    known, weight = np.append(counts, 0), np.append(times, np.max(times))
    while True:
        held = np.abs(known - centre) <= reach
        f = _steps_fitted(known[held] - centre, weight[held], f)
        if reach >= farthest:
            return _steps_fitted(counts, times, f)
        reach *= 2


def _steps_fitted(counts: Counts, times: Counts, f: float) -> float:
    """Whole steps k of the counts c by least squares of c = k / f."""
    steps = np.round(counts * f)
    along = float(times @ (steps * counts))
    return float(times @ steps**2) / along if along > 0.0 else f


def _finely(counts: Counts, times: Counts, f: float) -> tuple[float, float]:
    """Evidence and frequency of the grid beside f that the counts lie on best."""
    farthest = float(np.max(np.abs(counts)))
    near = f + AROUND * min(1.0 / (4 * PADDED * (np.ptp(counts) + 1.0)), ROUNDED * f / farthest)
    found = np.array([_evidence(counts, times, one) for one in near])
    return float(found.max()), float(np.mean(near[found >= found.max() - AS_GOOD]))


def _evidence(counts: Counts, times: Counts, f: float) -> float:
    """(1) against even phases, each count that many times, the noise the likeliest one."""
    beside = (counts * f - np.round(counts * f)) / f
    p = (
        sum(ndtr((z + 0.5) / NOISES) - ndtr((z - 0.5) / NOISES) for z in (beside - 1.0 / f, beside, beside + 1.0 / f))
        / f
    )
    return float(np.max(np.log(STRAY + (1.0 - STRAY) * p) @ times))


def _lies(each: float, different: int, span: int, f: float) -> bool:
    """Whether the evidence of each reading, of so many different ones over `span` counts, is a grid's: beyond chance, as the same count
    again says nothing new and as many grids differ as there are counts, and a good part of what readings without noise would show."""
    return (
        f > 0.0 and each * different > decisions.GRID_NATS + np.log(span) and each > decisions.GRID_SHARE * -np.log(f)
    )
