"""The reference filter that a log betrays: time constants found by fit, then tried as the round numbers that people write."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from records.table import ControllerTable, lag_gain
from replay import thresholds
from replay.flight import ReplayedLog
from replay.law import ReplayLaw, Setup
from replay.variants import Variant, prefilter_gains

Array = NDArray[np.float64]

GRID = 71
GOLDEN_STEPS = 36  # leave 1e-8 of a time constant: what is written has six digits at most
SPAN = 1500  # samples behind the reference's first move that the fit looks at
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def fitted_prefilters(table: ControllerTable, flight: ReplayedLog, inputs: NDArray[Any]) -> Iterator[Variant]:
    """All axes with the time constants that fit the log best, rounded to few digits, then to more; none where no reference moves.

    `inputs` (n, 2 loops) are what the law was given. One axis after the other is fitted to its own input: the elevation to u_M alone, the
    azimuth then to u_T, on which both act.
    """
    window = _window(flight)
    if window is None:
        return
    given = np.ascontiguousarray(inputs[:window], dtype=np.float32)
    logged = flight.logged_V[:window]
    names = [loop.axis for loop in table.loops]
    found_s = [_constant(table, axis) for axis in range(len(names))]
    for axis in range(len(names)):
        if np.ptp(flight.reference_rad[:window, axis][~np.isnan(flight.reference_rad[:window, axis])]) > 0.0:
            found_s[axis] = _fitted(partial(_misfit, table, given, logged, axis, tuple(found_s)))
    for digits in thresholds.WRITTEN_DIGITS:
        constants_s = tuple(float(f"{value:.{digits}g}") for value in found_s)
        shown = " and ".join(f"{value:g} s" for value in constants_s)
        sentence = f"filters its references with time constants of {shown} ({' and '.join(names)})"
        yield Variant("other_prefilter", "prefilter", sentence, partial(_with_constants, constants_s=constants_s))


def _window(flight: ReplayedLog) -> int | None:
    moved = np.flatnonzero(np.any(np.diff(flight.reference_rad, axis=0) != 0.0, axis=1))
    return None if not moved.size else min(int(moved[0]) + SPAN, len(flight.t_s))


def _constant(table: ControllerTable, axis: int) -> float:
    return float(table.axes[axis].prefilter_time_constant_s)


def _with_constants(setup: Setup, constants_s: tuple[float, ...]) -> Setup:
    for loop, constant_s in zip(setup.table.loops, constants_s, strict=True):
        setup = setup.with_axis(loop.axis, prefilter_time_constant_s=constant_s)
    return setup


def _misfit(
    table: ControllerTable,
    given: NDArray[Any],
    logged: Array,
    axis: int,
    others_s: tuple[float, ...],
    constant_s: float,
) -> float:
    """Mean error of one input [V] over the window with this axis' time constant."""
    constants_s = tuple(constant_s if index == axis else other for index, other in enumerate(others_s))
    filtered = _with_constants(Setup(table), constants_s).table
    setup = Setup(table, prefilter_gains=prefilter_gains(filtered, lag_gain))
    return float(np.nanmean(np.abs(ReplayLaw(setup).outputs(given)[:, axis] - logged[:, axis])))


def _fitted(misfit: Callable[[float], float]) -> float:
    """The time constant of least misfit: a grid, then the golden section around its best point, in the logarithm."""
    exponents = np.linspace(thresholds.LOG10_RANGE_S[0], thresholds.LOG10_RANGE_S[1], GRID)
    errors = [misfit(10.0**exponent) for exponent in exponents]
    best = int(np.argmin(errors))
    low, high = exponents[max(best - 1, 0)], exponents[min(best + 1, GRID - 1)]
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = misfit(10.0**left), misfit(10.0**right)
    for _ in range(GOLDEN_STEPS):
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = misfit(10.0**left)
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = misfit(10.0**right)
    return float(10.0 ** ((low + high) / 2.0))
