"""Whether a measured position moves as the plant does, or so many times as far: which of two units it is in.

A grid does not tell: steps of 0.2 rad are those of a sensor of 0.2 deg in degrees, and of a coarse sensor in radians.
"""

import numpy as np
from numpy.typing import NDArray

from logcheck.ahead import read_ahead, states_along, with_axes_as_read
from logcheck.finding import Array
from records.log import RunLog
from sim.bind import BoundPlant

AHEAD_S = 0.5  # over which inputs bend a path by more than a coarse sensor rounds it
WINDOWS = 200  # spread over a log: time


def misfit(log: RunLog, bound: BoundPlant, column: str, divided_by: float) -> float:
    """How far an output that is an axis' position, divided so, is from what the model does with the logged inputs; 1 for no better than a
    straight line, infinite where no window can be simulated.

    A window's error is the model's position AHEAD_S later less the one that was read, both against going on straight on:
    R = sum (y - y_model)^2 / sum (y - y_straight)^2. In the right unit R is below that in a wrong one: numbers too large by 57 bend 57
    times as far as the model does, R near 1; numbers too small bend a 57th of it, R far above.
    """
    rows = max(2, round(AHEAD_S / log.sample_period_s))
    half = rows // 2
    y = log.column(column) / divided_by
    starts = _starts(log, y, rows, half)
    if not starts.size:
        return np.inf
    rate = _rate(log, y, starts, half)
    straight = y[starts] + rate * rows * log.sample_period_s
    read = {out: log.column(out) for out in bound.model.outputs} | {column: y}
    begun = {out: (values[starts], _rate(log, values, starts, half)) for out, values in read.items()}
    x0 = with_axes_as_read(bound, states_along(log, bound)[starts], begun)
    model = read_ahead(log, bound, column, starts, x0, rows)
    if model is None:
        return np.inf
    error, bend = y[starts + rows] - model, y[starts + rows] - straight
    told = np.isfinite(error) & np.isfinite(bend)
    whole = float(np.sum(bend[told] ** 2))
    return float(np.sum(error[told] ** 2)) / whole if whole > 0.0 else np.inf


def _rate(log: RunLog, y: Array, starts: NDArray[np.int64], half: int) -> Array:
    """dy/dt about each start, from half a window's rows to both sides."""
    return np.asarray((y[starts + half] - y[starts - half]) / (2 * half * log.sample_period_s))


def _starts(log: RunLog, y: Array, rows: int, half: int) -> NDArray[np.int64]:
    """Rows from which windows begin: at even times within, every output of them read."""
    every = np.linspace(half, len(y) - rows - 1, WINDOWS).astype(int) if len(y) > rows + half + 1 else np.arange(0)
    read = np.isfinite(y) & np.isfinite(log.y).all(axis=1)
    span = (rows + half) * log.sample_period_s
    even = [k for k in np.unique(every) if abs(log.t_s[k + rows] - log.t_s[k - half] - span) < log.sample_period_s]
    return np.array([k for k in even if read[k - half] and read[k] and read[k + half] and read[k + rows]], dtype=int)
