"""Logs cut into windows of one second, each with a start that is read off the data and a prediction by the plant."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from records.log import RunLog
from sim.bind import BoundPlant
from sim.model import Model
from sim.simulate import Conditions, simulate

FREE_RUN_S = 1.0
SMOOTHED_ROWS = 11  # odd; over them an angle is taken for a parabola
GAP = 1.5  # sample periods between two rows that do not belong to one window
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Windows:
    """Windows over common times t_s (n,): starts x0 (windows, states), inputs u (windows, n, inputs), outputs y (windows, n, outputs)."""

    t_s: Array
    x0: Array
    u: Array
    y: Array


def windows_of(bound: BoundPlant, logs: Sequence[RunLog]) -> Windows:
    """All whole windows without missing rows; logs of one sample period, which is taken for exact."""
    period_s = logs[0].sample_period_s
    rows = round(FREE_RUN_S / period_s)
    cut = [_cut(log, states_of(bound, log), rows) for log in logs]
    x0, u, y = (np.concatenate([part[index] for part in cut]) for index in range(3))
    return Windows(period_s * np.arange(rows, dtype=np.float64), x0, u, y)


def errors(bound: BoundPlant, windows: Windows, p: Array | None = None) -> Array:
    """Prediction less measurement, shape (windows, n, outputs); 0 where nothing was measured."""
    t_s, u = windows.t_s, np.ascontiguousarray(windows.u)
    predicted = simulate(bound, t_s, windows.x0, u, Conditions(p=p, resolution=np.zeros(windows.y.shape[2]), keep="y"))
    return np.nan_to_num(np.asarray(predicted.y) - windows.y)


def states_of(bound: BoundPlant, log: RunLog) -> Array:
    """States at every row: angles and speeds from smoothed outputs, all others from the equations with the axes held."""
    model = bound.model
    held = simulate(
        bound,
        log.t_s,
        np.zeros(len(model.states)),
        log.u,
        Conditions(locked=tuple(axis.name for axis in model.axes if axis.position is not None), keep="x"),
    )
    x = np.array(held.x)
    for position, velocity, output in measured_axes(model):
        smooth, slope, _ = derivatives(log.y[:, output], log.sample_period_s)
        x[:, model.states.index(position)], x[:, model.states.index(velocity)] = smooth, slope
    for place, state in enumerate(model.states):
        if str(state) in log.extra:
            x[:, place] = log.column(str(state))
    return x


def measured_axes(model: Model) -> list[tuple[object, object, int]]:
    """(position, velocity, index of the output) of each axis whose position is measured as it is."""
    outputs = list(model.outputs.values())
    return [(a.position, a.velocity, outputs.index(a.position)) for a in model.axes if a.position in outputs]


def derivatives(y: Array, period_s: float) -> tuple[Array, Array, Array]:
    """A measured angle smoothed, its speed and its acceleration; missing values are bridged by straight lines."""
    seen = np.isfinite(y)
    rows = np.arange(len(y))
    whole = np.interp(rows, rows[seen], y[seen])
    smooth, slope, bend = (savgol_filter(whole, SMOOTHED_ROWS, 2, deriv=order, delta=period_s) for order in (0, 1, 2))
    return smooth, slope, bend


def _cut(log: RunLog, states: Array, rows: int) -> tuple[Array, Array, Array]:
    starts = [start for start in range(SMOOTHED_ROWS, len(log.t_s) - rows, rows) if _whole(log, start, rows)]
    pick = np.add.outer(np.array(starts, dtype=int), np.arange(rows))
    return states[np.array(starts, dtype=int)], log.u[pick], log.y[pick]


def _whole(log: RunLog, start: int, rows: int) -> bool:
    span = slice(start, start + rows)
    return bool(np.all(np.diff(log.t_s[span]) < GAP * log.sample_period_s) and np.all(np.isfinite(log.u[span])))
