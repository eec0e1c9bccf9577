"""Readings that lie on a coarser grid than their encoder's: which grid, and how unlikely that is by chance."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
OCCUPIED = 0.75  # share of the counts between the extremes that a fine encoder visits at least
ENOUGH = 8  # different readings
ON_GRID = 0.98
TRIALS = 4001


def coarse_step(y: Array, step: float) -> float | None:
    """The step of the grid that the readings y (n,) lie on where it is coarser than `step`; None where it is not."""
    values = np.unique(np.round(y[np.isfinite(y)] / step)) * step
    if step <= 0.0 or len(values) < ENOUGH:
        return None
    span = float(np.ptp(values))
    if len(values) > OCCUPIED * (span / step + 1.0):
        return None
    typical = float(np.median(np.diff(values)))
    tried = np.linspace(0.8, 1.2, TRIALS) * typical
    misses = np.abs(values[:, None] - tried * np.round(values[:, None] / tried)).max(axis=0)
    best = float(tried[np.argmin(misses)])
    return best if on_grid(values, best, step) >= ON_GRID and best > 1.5 * step else None


def on_grid(values: Array, grid: float, step: float) -> float:
    """Share of the values that lie within an encoder step of a grid's points."""
    return float(np.mean(np.abs(values - grid * np.round(values / grid)) <= 0.75 * step))


def grid_evidence(y: Array, grid: float, step: float) -> float:
    """Log likelihood that readings gain from lying on a grid instead of anywhere: for each change of the reading ln(grid / step)."""
    values = y[np.isfinite(y)]
    if grid <= 1.5 * step or len(values) < 2:
        return 0.0
    changes = values[1:][np.diff(values) != 0.0]
    if len(changes) == 0 or on_grid(changes, grid, step) < ON_GRID:
        return 0.0
    return float(len(changes) * np.log(grid / (1.5 * step)))
