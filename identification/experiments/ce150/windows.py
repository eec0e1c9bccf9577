"""Encoder readings of one axis, cut into windows with free starts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.model.driven import driven_model
from identification.model.subsystem import subsystem
from identification.runs.log_run import rounding_sd
from identification.runs.run import Carried, Run
from identification.runs.window_starts import lines, position_sd
from records.errors import BadInput
from sim.bind import BoundPlant
from sim.model import Model

Array = NDArray[np.float64]
Index = NDArray[np.int64]
SHIFT_S, SPEED_ROWS = 2.0, 6


@dataclass(frozen=True, eq=False)
class Readings:
    """What a record has of one axis: times (n,), the model's inputs (n, inputs), readings (n,) of the output of this name."""

    t_s: Array
    u: Array
    angle: Array
    output: str


def windowed(name: str, part: BoundPlant, readings: Readings, begins: Index, stops: Index) -> Run:
    """A run of a subsystem with one axis: its rotor runs on from rest at the first row, angle and speed start anew in each window.

    Raises BadInput where there is no window: the axis never moved freely.
    """
    if not begins.size:
        raise BadInput(
            "motion", f"experiment {name}", "no stretch in which the axis moves freely", "at least one",
            "check the mount and the locks, and record again: an axis at rest tells nothing",
        )  # fmt: skip
    t_s, angle = readings.t_s, readings.angle
    step = part.plant.sensors[readings.output]
    select = np.concatenate([np.arange(a, b) for a, b in zip(begins, stops, strict=True)])
    x0, free, start_sd = _starts(part.model, t_s, angle, begins, step)
    return Run(
        name=name,
        bound=part,
        t_s=t_s,
        u=readings.u,
        y=angle[select],
        sd=rounding_sd(angle, step)[select],
        at_s=t_s[select],
        channel=np.zeros(select.size, dtype=np.int64),
        channels=(readings.output,),
        select=select,
        begins=begins,
        stops=stops,
        x0=x0,
        free=free,
        start_sd=start_sd,
        carried=_from_rest(part),
        step=np.array([step]),
    )


def _from_rest(part: BoundPlant) -> Carried | None:
    driven = driven_model(part.model)
    return None if driven is None else Carried(subsystem(part, driven), np.zeros(len(driven.states)))


def _starts(model: Model, t_s: Array, angle: Array, begins: Index, step: float) -> tuple[Array, tuple[str, str], Array]:
    """Guessed states of the axis at the windows' first rows, which of them are free, and how far the guess may be off."""
    axis = model.axes[0]
    assert axis.position is not None
    level, slope, _, _ = lines(t_s, angle, begins, step)
    x0 = np.zeros((begins.size, len(model.states)))
    x0[:, model.states.index(axis.position)] = level
    x0[:, model.states.index(axis.velocity)] = slope
    start_sd = np.tile([position_sd(angle, step), max(3.0 * float(np.std(slope)), 1.0)], (begins.size, 1))
    return x0, (str(axis.position), str(axis.velocity)), start_sd


def even_windows(t_s: Array, angle: Array, from_s: float, length_s: float) -> tuple[Index, Index]:
    """Windows of about equal length from `from_s` on to the end, each moved to begin where the axis is fast.

    A start that is almost at rest may slip to either side, and the fit would have to find out which.
    """
    first = int(np.searchsorted(t_s, from_s))
    edges = np.searchsorted(t_s, np.arange(t_s[first], t_s[-1] - 0.5 * length_s, length_s))
    begins = np.array([fastest_row(t_s, angle, int(row), SHIFT_S) for row in edges], dtype=np.int64)
    return begins, np.append(begins[1:], t_s.size).astype(np.int64)


def fastest_row(t_s: Array, angle: Array, row: int, within_s: float) -> int:
    """The row within `within_s` behind `row` at which the angle changes most over `SPEED_ROWS` rows."""
    last = min(int(np.searchsorted(t_s, t_s[row] + within_s)), t_s.size - SPEED_ROWS - 1)
    rows = np.arange(row, max(row + 1, last))
    change = np.abs(angle[np.minimum(rows + SPEED_ROWS, t_s.size - 1)] - angle[rows])
    return int(rows[np.argmax(np.nan_to_num(change))] + SPEED_ROWS // 2)
