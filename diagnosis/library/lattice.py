"""Readings that lie on a coarser grid than their encoder's: which grid, and how unlikely that is by chance."""

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions

Array = NDArray[np.float64]
ROUNDED, NO_STEP = 0.51, 1e-3  # encoder steps that rounding leaves at most; grids of no more than a step have no twin
GRID_ROUGHLY, GRID_FINELY, AROUND = 0.2, 2e-4, np.linspace(-1.0, 1.0, 4001)


def coarse_step(y: Array, step: float) -> float | None:
    """The step of the grid that the readings y (n,) lie on where it is coarser than `step`; None where it is not."""
    values = np.unique(np.round(y[np.isfinite(y)] / step)) * step
    if step <= 0.0 or len(values) < decisions.LEAST_VALUES:
        return None
    span = float(np.ptp(values))
    if len(values) > decisions.OCCUPIED_SHARE * (span / step + 1.0):
        return None
    near = _nearest(values, float(np.median(np.diff(values))) * (1.0 + GRID_ROUGHLY * AROUND))[0]
    twin = near / max(near / step - 1.0, NO_STEP)  # meets the same counts, but for rounding
    fine = [
        _nearest(values, grid * (1.0 + GRID_FINELY * AROUND))
        for grid in (near, twin)
        if grid > decisions.COARSE_STEP * step
    ]
    if not fine:
        return None
    best = max((grid for grid, miss in fine if miss <= ROUNDED * step), default=min(fine, key=lambda one: one[1])[0])
    lies = (
        on_grid(values, best, step) >= decisions.ON_GRID_SHARE
        and on_grid(_counts(values, step), best, step) <= decisions.OCCUPIED_SHARE
    )
    return best if lies else None


def _nearest(values: Array, grids: Array) -> tuple[float, float]:
    """The one of the grids' steps from whose points the values stay least far, and how far."""
    misses = np.abs(values[:, None] - grids * np.round(values[:, None] / grids)).max(axis=0)
    return float(grids[np.argmin(misses)]), float(misses.min())


def on_grid(values: Array, grid: float, step: float) -> float:
    """Share of the values that lie on a grid's points, as an encoder rounds them."""
    return float(np.mean(np.abs(values - grid * np.round(values / grid)) <= decisions.WITHIN_STEPS * step))


def grid_evidence(y: Array, grid: float, step: float) -> float:
    """Log likelihood that readings gain from lying on a grid instead of anywhere: for each change of the reading -ln of the share of the
    encoder's counts that lie on it. That share is counted: a grid of 5/3 steps, say, is near every count, and tells nothing."""
    values = y[np.isfinite(y)]
    if grid <= decisions.COARSE_STEP * step or len(values) < 2:
        return 0.0
    changes = values[1:][np.diff(values) != 0.0]
    if len(changes) == 0 or on_grid(changes, grid, step) < decisions.ON_GRID_SHARE:
        return 0.0
    return float(-len(changes) * np.log(on_grid(_counts(changes, step), grid, step)))


def _counts(values: Array, step: float) -> Array:
    """All that an encoder of this step can read between the extremes of the values."""
    return step * np.arange(np.round(values.min() / step), np.round(values.max() / step) + 1.0)
