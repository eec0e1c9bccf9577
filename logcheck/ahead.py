"""Where the plant says that an output is a little later, from rows of a log on, with the inputs that were logged."""

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import Array
from records.log import RunLog
from sim.bind import BoundPlant
from sim.simulate import Conditions, simulate


def states_along(log: RunLog, bound: BoundPlant) -> Array:
    """All states of a free run with the log's inputs, shape (rows, states): for those that no axis has, rotors and windings."""
    before = max(1, round(thresholds.RUN_UP_S / log.sample_period_s))
    u = np.concatenate([np.repeat(log.u[:1], before, axis=0), log.u])
    with np.errstate(all="ignore"):
        runs = simulate(
            bound, np.arange(len(u)) * log.sample_period_s, np.zeros(len(bound.model.states)), u, Conditions(keep="x")
        )
    states: Array = np.nan_to_num(np.asarray(runs.x))[before:]
    return states


def read_ahead(
    log: RunLog, bound: BoundPlant, column: str, starts: NDArray[np.int64], x0: Array, rows: int
) -> Array | None:
    """The model's reading (starts,) of an output so many rows behind each start, from states x0 (starts, states) there; None where it
    cannot be simulated."""
    u = np.stack([log.u[start : start + rows + 1] for start in starts])
    times = np.arange(rows + 1) * log.sample_period_s
    with np.errstate(all="ignore"):
        runs = simulate(
            bound,
            times,
            x0,
            u,
            Conditions(resolution=np.zeros(len(bound.model.outputs)), locked=tuple(log.locked), keep="y"),
        )
    return None if runs.y is None else np.asarray(runs.y[:, -1, list(bound.model.outputs).index(column)])


def with_axes_as_read(bound: BoundPlant, states: Array, read: dict[str, tuple[Array, Array]]) -> Array:
    """The states (starts, states) with the positions and speeds (starts,) of those axes whose output was `read`."""
    names, states = [str(state) for state in bound.model.states], states.copy()
    for axis in bound.model.axes:
        for output, expression in bound.model.outputs.items():
            if str(expression) == str(axis.position) and output in read:
                states[:, names.index(str(axis.position))], states[:, names.index(str(axis.velocity))] = read[output]
    return states
