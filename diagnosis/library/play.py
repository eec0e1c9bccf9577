"""Readings behind play: where the axis surely pushes it is half the play further, elsewhere it is anywhere within it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput
from diagnosis.library.reading_spans import UniformError, charge, less_sure
from sim.paths.path import played

Array = NDArray[np.float64]
# A reading behind play says that the axis lies within it, no more: as a bell of the same variance an interval costs ln sqrt(12 / 2 pi).
BELL = 0.32


def behind_play(filter_input: FilterInput, output: int, width: float, step: float) -> FilterInput:
    """The filter input where an output's readings, counts of `step`, follow it behind play of that width.

    While the axis crosses the play its reading stands: all readings of such a stretch are off by one error, and what they scatter is noise.
    """
    y, single = filter_input.y.copy(), float(filter_input.single[output])
    seen = np.flatnonzero(np.isfinite(y[:, output]))
    read = filter_input.read[seen, output]
    # What noise does back and forth, a count and the range of n readings, 2 sqrt(2 ln n) standard deviations, is no motion: play that is no
    # wider shows in nothing.
    reach = step + 2.0 * float(np.sqrt(2.0 * max(single - step**2 / 12.0, 0.0) * np.log(max(len(read), 1))))
    if width <= reach:
        return filter_input
    way, moved = pushing(read, reach), _moves(read, reach) != 0.0
    y[seen, output] += 0.5 * width * way
    unsure, begins = way == 0.0, np.append(np.zeros(min(len(way), 1)), np.diff(way)) != 0.0
    crossing, stretch = (
        np.cumsum(begins),
        np.cumsum(begins | moved),
    )  # what moves the reading within a crossing is no noise
    rows = np.bincount(crossing, minlength=1)[crossing]
    alike = np.maximum(rows[unsure], filter_input.standing[seen[unsure], output])
    error = UniformError(width, min(BELL, charge(filter_input, output, width)))
    found = less_sure(replace(filter_input, y=y), output, seen[unsure], alike, error)
    before, behind = (given.r[seen[unsure], output] for given in (filter_input, found))
    scattered = float((1.0 - before / behind) @ _noise_nats(read[unsure], stretch[unsure], step, single))
    return replace(found, known=found.known - scattered)


def _noise_nats(read: Array, stretch: NDArray[np.int64], step: float, single: float) -> Array:
    """What readings (n,) cost as noise about the mean of their stretch, of the variance that they show or, where that is larger, of a
    `single` one: less sure, none of it costs the filter anything. Of a stretch beside an edge either count may be read: half a step off."""
    _, stretch, counts = np.unique(stretch, return_inverse=True, return_counts=True)
    away = read - (np.bincount(stretch, read, minlength=len(counts)) / counts)[stretch]
    variance = max(float(away @ away) / max(len(read) - len(counts), 1), single)
    return 0.5 * (away**2 / max(variance, 0.25 * step**2) + float(np.log(variance / single)))


def pushing(read: Array, noise: float) -> Array:
    """The way (n,) in which an axis surely pushes at each of its readings, 1 or -1; 0 where it may be anywhere within the play: the reading
    has not changed for longer than it usually takes, or changes back next.

    What moves no further than `noise` back and forth moves nothing behind play so wide. Looked at from behind, that shows a reversal too
    early, as from before too late.
    """
    rows = np.arange(len(read))
    moved, coming = _moves(read, noise), _moves(read[::-1], noise)[::-1]
    changes = np.flatnonzero(moved)
    if len(changes) < 2:  # nothing tells how long a reading usually stands
        return np.zeros(len(read))
    before = np.searchsorted(changes, rows, side="right") - 1
    standing = rows - changes[np.maximum(before, 0)]
    way = np.where(before < 0, 0.0, moved[changes[np.maximum(before, 0)]])
    turns = way != -_last(coming[::-1])[::-1]
    return np.where(turns | (standing > 2.0 * float(np.median(np.diff(changes)))), 0.0, way)


def _moves(read: Array, noise: float) -> Array:
    """The way (n,) in which each reading moved what follows it behind play as wide as its noise; 0 where it moved nothing."""
    followed = played(read, noise, None)[0] if len(read) else read
    return np.append(np.zeros(min(len(read), 1)), np.sign(np.diff(followed)))


def _last(moves: Array) -> Array:
    """The last move up to each reading that is none of 0; 0 before the first."""
    last = np.maximum.accumulate(np.where(moves != 0.0, np.arange(len(moves)), -1))
    return np.where(last < 0, 0.0, moves[np.maximum(last, 0)])
