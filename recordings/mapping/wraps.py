"""Counters that ran over: ticks of a clock and counts of an encoder in a narrow integer, angles within one turn."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

INTEGERS = (2.0**16, 2.0**24, 2.0**32)  # of counters: 16 and 24 bits of timers, 32 of millis() and micros()
NEAR = 0.1  # of the range: a step that is as near to the whole of it is a counter that ran over
NEXT_STEPS = 4.0  # usual steps: behind its end a clock goes on within so many, where another recording begins anywhere


def clock_past_its_end(ticks: Array) -> tuple[Array, float | None]:
    """Ticks (n,) of a clock counted on where they ran over, and the integer's range; as they are, and None, where they did not."""
    if ticks.size < 2 or not _are_whole(ticks):
        return ticks, None
    steps = np.diff(ticks)
    falls, usual = steps < 0.0, float(np.median(steps))
    for size in INTEGERS if falls.any() else ():
        least = -0.5 * size if ticks.min() < 0.0 else 0.0  # of a signed integer
        over = steps[falls] + size
        within = ticks.min() >= least and ticks.max() < least + size
        if within and np.all((over > 0.0) & (over <= NEXT_STEPS * usual)):
            return np.concatenate([ticks[:1], ticks[0] + np.cumsum(np.where(falls, steps + size, steps))]), size
    return ticks, None


def angle_past_its_end(values: Array, sizes: Sequence[float]) -> tuple[Array, int, float]:
    """An angle (n,) without its leaps of the first of `sizes` that it has, in the branch nearest to 0; how many, and of which size.

    As it is, with 0 leaps, where it has none, or where it is not within one such range.
    """
    known = np.flatnonzero(np.isfinite(values))
    there = values[known]
    for size in sizes if there.size > 1 and np.ptp(there) > 0.0 else ():
        leaps = int(np.sum(np.abs(np.diff(there)) >= (1.0 - NEAR) * size))
        if leaps and np.ptp(there) <= size:
            whole = np.unwrap(there, period=size)
            counted = values.copy()
            counted[known] = whole - size * np.round(np.median(whole) / size)
            return counted, leaps, size
    return values, 0, 0.0


def counter_size(values: Array) -> float | None:
    """The range of the integer in which whole numbers (n,) run over; None where they do not."""
    known = values[np.isfinite(values)] if values.ndim == 1 else values[:0]
    _, leaps, size = angle_past_its_end(known, INTEGERS)
    return size if leaps and _are_whole(known) else None


def _are_whole(values: Array) -> bool:
    return bool(np.all(np.isfinite(values)) and np.all(values == np.round(values)))
