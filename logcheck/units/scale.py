"""Whether a measured position moves as the plant does, or so many times as far: which of two units it is in.

A grid does not tell: steps of 0.2 rad are those of a sensor of 0.2 deg in degrees, and of a coarse sensor in radians.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from logcheck.finding import Array
from records.log import RunLog
from sim.bind import BoundPlant
from sim.simulate import simulate

AHEAD_S = 0.5  # over which inputs bend a path by more than a coarse sensor rounds it
SETTLE_S = 2.0  # with the first inputs before a log: rotors turn as these make them
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
    begun = _begun(log, bound, starts, half, {column: y})
    u = np.stack([log.u[start : start + rows + 1] for start in starts])
    times = np.arange(rows + 1) * log.sample_period_s
    with np.errstate(all="ignore"):
        runs = simulate(bound, times, begun, u, resolution=np.zeros(len(bound.model.outputs)), keep="y")
    if runs.y is None:
        return np.inf
    model = runs.y[:, -1, list(bound.model.outputs).index(column)]
    error, bend = y[starts + rows] - model, y[starts + rows] - straight
    told = np.isfinite(error) & np.isfinite(bend)
    whole = float(np.sum(bend[told] ** 2))
    return float(np.sum(error[told] ** 2)) / whole if whole > 0.0 else np.inf


def _rate(log: RunLog, y: Array, starts: NDArray[np.int64], half: int) -> Array:
    """dy/dt about each start, from half a window's rows to both sides."""
    return np.asarray((y[starts + half] - y[starts - half]) / (2 * half * log.sample_period_s))


def _begun(log: RunLog, bound: BoundPlant, starts: NDArray[np.int64], half: int, instead: Mapping[str, Array]) -> Array:
    """States (starts, states) from which the model goes on: positions and speeds as read, some outputs as they stand `instead`."""
    begun = _states(log, bound)[starts]
    for axis in bound.model.axes:
        outputs = [out for out, expression in bound.model.outputs.items() if str(expression) == str(axis.position)]
        if outputs:
            y = instead[outputs[0]] if outputs[0] in instead else log.column(outputs[0])
            begun[:, _index(bound, str(axis.position))] = y[starts]
            begun[:, _index(bound, str(axis.velocity))] = _rate(log, y, starts, half)
    return begun


def _starts(log: RunLog, y: Array, rows: int, half: int) -> NDArray[np.int64]:
    """Rows from which windows begin: at even times within, every output of them read."""
    every = np.linspace(half, len(y) - rows - 1, WINDOWS).astype(int) if len(y) > rows + half + 1 else np.arange(0)
    read = np.isfinite(y) & np.isfinite(log.y).all(axis=1)
    span = (rows + half) * log.sample_period_s
    even = [k for k in np.unique(every) if abs(log.t_s[k + rows] - log.t_s[k - half] - span) < log.sample_period_s]
    return np.array([k for k in even if read[k - half] and read[k] and read[k + half] and read[k + rows]], dtype=int)


def _states(log: RunLog, bound: BoundPlant) -> Array:
    """All states of a free run with the log's inputs, shape (rows, states): for those that no axis has, rotors and windings."""
    before = max(1, round(SETTLE_S / log.sample_period_s))
    u = np.concatenate([np.repeat(log.u[:1], before, axis=0), log.u])
    with np.errstate(all="ignore"):
        runs = simulate(bound, np.arange(len(u)) * log.sample_period_s, np.zeros(len(bound.model.states)), u, keep="x")
    states: Array = np.nan_to_num(np.asarray(runs.x))[before:]
    return states


def _index(bound: BoundPlant, state: str) -> int:
    return [str(each) for each in bound.model.states].index(state)
