"""An axis that never moves though its plant would: held by a hand, or a sensor that is not read. Neither is the plant's fault."""

from collections.abc import Iterator

import numpy as np

from logcheck import thresholds
from logcheck.finding import REFUSE, Array, Finding, Found
from records.log import RunLog
from sim.bind import BoundPlant
from sim.model import Axis
from sim.simulate import simulate

RUN_UP_S = 4.0  # for rotors to come to their speed


def locked_findings(log: RunLog, name: str, bound: BoundPlant) -> Iterator[Found]:
    """Axes whose reading is one number throughout, that are not declared locked, and that the log's inputs would move."""
    columns = {str(expression): output for output, expression in bound.model.outputs.items()}
    for axis in bound.model.axes:
        column = columns.get(str(axis.position))
        if column is None or axis.name in log.locked:
            continue
        read = log.column(column)[np.isfinite(log.column(column))]
        if read.size == 0 or read.min() != read.max():
            continue
        moved = _would_move(log, bound, axis, float(read[0]))
        if moved > thresholds.WOULD_MOVE:
            span = (float(log.t_s[0]), float(log.t_s[-1]))
            sentence = f"{column} is {read[0]:g} in every row, where these inputs would move it by {moved:.2g}"
            remedy = f'where it was held, say so in the sidecar: locked = ["{axis.name}"]; else check its sensor'
            yield Found(
                Finding("axis_stands", name, column, *span, sentence, REFUSE, 0, "an axis that answers", remedy)
            )


def _would_move(log: RunLog, bound: BoundPlant, axis: Axis, angle: float) -> float:
    """How far the stated plant moves the axis from `angle` under the log's inputs, the other axes held; 0 where that cannot be said."""
    states = [str(state) for state in bound.model.states]
    place, others = states.index(str(axis.position)), [other.name for other in bound.model.axes if other is not axis]
    x0 = np.zeros(len(states))
    x0[place] = angle
    run_up = np.arange(0.0, RUN_UP_S, 0.01)
    x = _states(bound, run_up, x0, np.tile(log.u[:1], (len(run_up), 1)), [axis.name, *others])
    rows = log.t_s - log.t_s[0] <= thresholds.LOCKED_S
    way = _states(bound, log.t_s[rows] - log.t_s[0], x[-1], log.u[rows], others)[:, place]
    return float(np.max(np.abs(way - angle))) if np.isfinite(way).all() else 0.0


def _states(bound: BoundPlant, t_s: Array, x0: Array, u: Array, locked: list[str]) -> Array:
    run = simulate(bound, t_s, x0, u, locked=tuple(locked), keep="x")
    assert run.x is not None
    return np.asarray(run.x)
