"""Readings of an axis that leap away for a row, by a few steps of its encoder, and back on its way: no mass moves so.

An edge that was counted twice, or a word on a bus that was read amid its change. What leaps farther than any motion is a glitch whatever
column it is in; these are small, and told by how even the way of the axis is on both sides. Where they are many, few have an even way
beside them: then that they come independently of one another tells them, as rows of any motion or shaking come together.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import EXCLUDE, Array, Finding, Found, Rows, in_words
from records.log import RunLog

Indices = NDArray[np.int64]
_BESIDE = 2  # rows on either side, which show where the axis goes


def spike_findings(log: RunLog, name: str, column: str, step: float) -> Iterator[Found]:
    """Rows in which an output that a mass moves is off the way of the rows beside, where it hardly ever is otherwise."""
    read = np.isfinite(log.column(column))
    values, clocks = log.column(column)[read], np.array([log.t_s, np.arange(len(read))])[:, read]
    moves = np.abs(np.diff(values))
    least = max(float(np.min(moves, initial=np.inf, where=moves > 0.0)), step)
    spikes = _single(clocks, values, least)
    if not spikes.size:
        spikes = _scattered(values, least)
    if spikes.size < max(thresholds.LEAST_SPIKES, thresholds.LEAST_SPIKES_SHARE * len(values)):
        return
    spikes = np.concatenate([spikes, _outermost(clocks, values, least)])
    for rows in range(thresholds.SPIKE_ROWS, 1, -1):
        kept = np.setdiff1d(np.arange(len(values)), spikes)
        more = kept[_ends(clocks[:, kept], values[kept], rows, least)]
        kept = np.setdiff1d(kept, more)  # what was near others stands alone when they are gone
        spikes = np.concatenate([spikes, more, kept[_single(clocks[:, kept], values[kept], least)]])
    out: Rows = np.zeros(len(read), bool)
    out[np.flatnonzero(read)[spikes]] = True
    at, count = log.t_s[out], int(out.sum())
    share = f"{in_words(count, 'row')}, {count / len(out):.1%} of all, first at {at[0]:.6g} s"
    sentence = f"{column} leaps off the way of its axis and back in {share}; left out"
    yield Found(Finding("spikes", name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, count), out)


def _single(clocks: Array, values: Array, least: float) -> Indices:
    """Rows that are off their way alone; none where as many others are off it, as those of a noisy sensor or of an axis that shakes."""
    row = np.arange(_BESIDE, len(values) - _BESIDE)
    if not row.size:
        return row
    off, agreed = _off(clocks, values, row, [(row - 1, row + 1), (row - 1, row - 2), (row + 1, row + 2)])
    far = off > thresholds.SPIKE_STEPS * least
    clear = far & agreed & (off > thresholds.SPIKE_FACTOR * float(np.percentile(off, thresholds.UNSPOILT_PERCENT)))
    if clear.sum() < thresholds.MOST_OFF_ARE_SPIKES * far.sum():
        return row[:0]
    between = np.diff(row[clear], prepend=-np.inf, append=np.inf)
    near = np.minimum(between[:-1], between[1:]) <= thresholds.SHAKES_ROWS
    return row[clear] if near.sum() <= thresholds.MOST_NEAR * near.size else row[:0]


def _scattered(values: Array, least: float) -> Indices:
    """Rows in many that are off the way of those around, and off the line through the others beside; none unless they come one
    independently of the other: as many have another so near as chance makes it of so large a share."""
    none: Indices = np.zeros(0, np.int64)
    if len(values) <= 2 * thresholds.SCATTER_AROUND:
        return none
    off = np.abs(values - _way(values, thresholds.SCATTER_AROUND))
    usual = thresholds.SPIKE_FACTOR * float(np.percentile(off, thresholds.SCATTER_PERCENT))
    bound = max(thresholds.SPIKE_STEPS * least, usual)
    row, far = np.arange(len(values)), off > bound
    if not far.any() or far.all():
        return none
    off = np.where(far, np.abs(values - np.interp(row, row[~far], values[~far])), off)
    far &= off > bound
    share, unsure = far.mean(), np.sum((off > 0.5 * bound) & ~far)
    if not thresholds.LEAST_SCATTERED <= share <= thresholds.MOST_SCATTERED:
        return none
    if unsure > thresholds.MOST_HALF_OFF * far.sum():
        return none
    between = np.diff(row[far], prepend=-np.inf, append=np.inf)
    near = np.mean(np.minimum(between[:-1], between[1:]) <= thresholds.SHAKES_ROWS)
    by_chance = 1.0 - (1.0 - share) ** (2 * thresholds.SHAKES_ROWS)
    return row[far] if abs(near - by_chance) <= thresholds.NEAR_BY_CHANCE else none


def _way(values: Array, rows: int) -> Array:
    """Where those up to so many rows on either side put each row: the median of them, each brought there by the median of their moves."""
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, rows, mode="edge"), 2 * rows + 1)
    moves = np.median(np.diff(windows, axis=1), axis=1)
    way: Array = np.median(windows - moves[:, np.newaxis] * np.arange(-rows, rows + 1), axis=1)
    return way


def _outermost(clocks: Array, values: Array, least: float) -> Indices:
    """Those of the first two and the last two rows that are off the way of the next three, of a column in which some others are."""
    last = len(values) - 1
    asked = [
        (0, (1, 2, 3)),
        (1, (0, 2, 3)),
        (last - 1, (last, last - 2, last - 3)),
        (last, (last - 1, last - 2, last - 3)),
    ]
    found = []
    for row, beside in asked:
        lines = [(np.array([one]), np.array([other])) for one, other in combinations(beside, 2)]
        off, agreed = _off(clocks, values, np.array([row]), lines)
        if agreed[0] and off[0] > thresholds.SPIKE_STEPS * least:
            found.append(row)
    return np.array(found, dtype=np.int64)


def _ends(clocks: Array, values: Array, rows: int, least: float) -> Indices:
    """The first and the last of so many rows, where both are off the way of the rows on either side of all."""
    first = np.arange(_BESIDE, len(values) - _BESIDE - rows + 1)
    last = first + rows - 1
    across = (first - 1, last + 1)
    found = [
        _off(clocks, values, row, [across, beside])
        for row, beside in ((first, (first - 1, first - 2)), (last, (last + 1, last + 2)))
    ]
    both = np.all([agreed & (off > thresholds.SPIKE_STEPS * least) for off, agreed in found], axis=0)
    return np.unique([first[both], last[both]])


def _off(
    clocks: Array, values: Array, row: Indices, through: Sequence[tuple[Indices, Indices]]
) -> tuple[Array, NDArray[np.bool_]]:
    """How far these rows are from lines through pairs of others, the least of all, 0 where the lines are not on one side; and whether they
    agree. By each of the clocks (2, n), times and row numbers: stamps may jitter where samples do not, and samples where rows do not."""
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.array(
            [
                values[row] - values[near] - (values[far] - values[near]) * (t[row] - t[near]) / (t[far] - t[near])
                for t in clocks
                for near, far in through
            ]
        )
        one_side = np.all(off > 0.0, axis=0) | np.all(off < 0.0, axis=0)
        least = np.where(one_side, np.abs(off).min(axis=0), 0.0)
        return least, np.ptp(off, axis=0) <= thresholds.SPIKE_SPREAD * least
