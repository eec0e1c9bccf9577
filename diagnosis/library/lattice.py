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
NEARLY_AS_HIGH = 0.8
LOWEST = 0.3  # of all counts in phase: those of a grid of 1.5 counts without noise are 0.41
AROUND = np.linspace(-1.0, 1.0, 81)
AS_GOOD = 1.0  # nats: frequencies that near the best are one plateau


def coarse_step(y: Array, step: float) -> float | None:
    """The step of the grid that the readings y (n,) lie on where it is coarser than `step`; None where it is not."""
    read = _counts(y, step)
    counts, times = np.unique(_passed(read), return_counts=True)
    if len(counts) < decisions.LEAST_VALUES:
        return None
    evidence, f = max((_finely(counts, times, f, width) for f, width in _peaks(counts, times)), default=(0.0, 0.0))
    different = min(len(np.unique(read)), int(times.sum()))
    return step / f if _lies(evidence / times.sum(), different, int(np.ptp(counts)) + 1, f) else None


def grid_evidence(y: Array, grid: float, step: float) -> float:
    """Log likelihood, by (1), that changes of the readings y (n,) gain from lying on a grid instead of anywhere; 0 where they do not."""
    counts = _counts(y, step)
    counts, times = np.unique(counts[1:][np.diff(counts) != 0], return_counts=True)
    if len(counts) == 0 or grid <= decisions.COARSE_STEP * step:
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


def _peaks(counts: Counts, times: Counts) -> list[tuple[float, float]]:
    """Frequencies (1/counts) at which the counts' spectrum is highest, with their twins, and how far from it a peak may be."""
    span = int(counts[-1] - counts[0]) + 1
    passes = np.zeros(span)
    passes[counts - counts[0]] = times
    points = 1 << (PADDED * span - 1).bit_length()
    height = np.abs(np.fft.rfft(passes, points))
    slowest = int(0.5 * decisions.LEAST_VALUES * points / span)
    height[:slowest] = 0.0  # a grid of fewer points between the extremes is none
    height[height < LOWEST * times.sum()] = 0.0
    inner = np.flatnonzero(
        (height >= np.append(0.0, height[:-1])) & (height >= np.append(height[1:], 0.0)) & (height > 0.0)
    )
    ranked = inner[np.argsort(height[inner])[::-1]]
    # Overtones of a grid that is read without noise are as high as its own frequency, the lowest of them.
    lowest = [place for place in inner if height[place] > NEARLY_AS_HIGH * height[ranked[0]]][:1]
    highest = np.array([*lowest, *ranked[:PEAKS]]) / points
    both = [f for peak in highest for f in (peak, 1.0 - peak)]
    return [(float(f), 1.0 / points) for f in both if f * decisions.COARSE_STEP < 1.0]


def _finely(counts: Counts, times: Counts, f: float, width: float) -> tuple[float, float]:
    """Evidence and frequency of the grid within `width` of f that the counts lie on best."""
    near = f + width * AROUND
    f = float(near[np.argmax(np.abs(np.exp(2j * np.pi * np.outer(near, counts)) @ times))])
    near = f + width / 4 * AROUND
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
