"""An output that stands though its plant would move it: throughout the log, or to its end, with or without a leap.

An axis that never moves is held by a hand, or its sensor is not read. At the end the rig was switched off, or its sensor no longer read:
elsewhere in the log it answers within so many rows when inputs have moved by half of their range; one that does not in three times as many
is not read. At an end of its range an axis may be stopped. None of it is the plant's fault.
"""

from collections.abc import Collection, Iterator, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import EXCLUDE, REFUSE, Array, Finding, Found, Rows
from logcheck.stands.dead import amount
from records.log import RunLog
from sim.bind import BoundPlant
from sim.model import Axis
from sim.simulate import Conditions, simulate


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
    run_up = np.arange(0.0, thresholds.RUN_UP_S, 0.01)
    x = _states(bound, run_up, x0, np.tile(log.u[:1], (len(run_up), 1)), [axis.name, *others])
    rows = log.t_s - log.t_s[0] <= thresholds.LOCKED_S
    way = _states(bound, log.t_s[rows] - log.t_s[0], x[-1], log.u[rows], others)[:, place]
    return float(np.max(np.abs(way - angle))) if np.isfinite(way).all() else 0.0


def _states(bound: BoundPlant, t_s: Array, x0: Array, u: Array, locked: list[str]) -> Array:
    run = simulate(bound, t_s, x0, u, Conditions(locked=tuple(locked), keep="x"))
    assert run.x is not None
    return np.asarray(run.x)


def end_findings(
    log: RunLog,
    name: str,
    steps: Mapping[str, float],
    begins: Rows,
    positions: Collection[str] = (),
    moved_by: Mapping[str, Collection[str]] = MappingProxyType({}),
) -> Iterator[Found]:
    """The last stand of each output, where inputs would have moved it, of those that do (`moved_by`); `begins` (n,) and `positions` as for
    dead stretches."""
    last = int(np.max(np.flatnonzero(begins), initial=0))
    for column in log.columns.outputs:
        found = last_stand(log, column, last, steps.get(column, 0.0))
        if found is None:
            continue
        present, begin, least = found
        own = [name in moved_by.get(column, log.columns.inputs) for name in log.columns.inputs]
        values, u = log.column(column)[present], log.u[present][:, own]
        if column in positions and _is_at_an_end(values, values[begin], least):
            continue
        waited, usually = _unanswered(values, u, begin)
        if waited < max(thresholds.ANSWER_ROWS, thresholds.ANSWER_TIMES * (usually + 1)):
            continue
        why = (
            f"{waited} rows of it after inputs had moved by half their range, which it answers within {usually + 1} elsewhere: the rig was "
            "off, or the sensor was not read"
        )
        yield dead_end(log, name, column, present, begin, why)


def dead_end(log: RunLog, name: str, column: str, present: NDArray[np.int64], begin: int, why: str) -> Found:
    """The finding of an output's last stand, which is left out: of the rows in which it was read, `present` (k,), that from `begin` on."""
    unread: Rows = np.zeros(len(log.t_s), bool)
    unread[present[begin + 1 :]] = True
    span = (float(log.t_s[present[begin]]), float(log.t_s[present[-1]]))
    level = log.column(column)[present[begin]]
    sentence = f"{column} stands at {level:.4g} from {span[0]:.6g} s to the end, {why}; left out"
    return Found(Finding("dead_end", name, column, *span, sentence, EXCLUDE, int(unread.sum())), unread)


def last_stand(log: RunLog, column: str, first: int, step: float) -> tuple[NDArray[np.int64], int, float] | None:
    """The rows from `first` on in which an output was read, which of them begins its last value, and its least move, the encoder's `step`
    at least; None where it never moves."""
    present = first + np.flatnonzero(np.isfinite(log.column(column)[first:]))
    moves = np.abs(np.diff(log.column(column)[present]))
    moved = np.flatnonzero(moves)
    return (present, int(moved[-1]) + 1, max(float(moves[moved].min()), step)) if moved.size else None


def off_findings(log: RunLog, name: str, bound: BoundPlant, steps: Mapping[str, float]) -> Iterator[Found]:
    """The end of a log in which nothing changes any more, begun by a leap of what a mass moves: the rig was switched off."""
    begin = _still_from(log)
    if len(log.t_s) - begin < thresholds.DEAD_ROWS or begin < 2:
        return
    for output, expression in bound.model.outputs.items():
        values = log.column(output)[: begin + 1]
        moves, step = np.abs(np.diff(values[np.isfinite(values)])), steps.get(output, 0.0)
        if str(expression) not in bound.model.axis_states or moves.size < 2 or not moves.any():
            continue
        near = moves[-1 - thresholds.AROUND_STAND_ROWS : -1].max(initial=0.0)
        usual = float(np.percentile(moves, thresholds.USUAL_MOVE_PERCENT))
        least = max(float(moves[moves > 0.0].min()), step)
        far = max(thresholds.BROKEN_OFF * max(near, least), usual, thresholds.LEAST_SEAM_STEPS * least)
        if moves[-1] > far:
            off = np.arange(len(log.t_s)) >= begin
            span = (float(log.t_s[begin]), float(log.t_s[-1]))
            sentence = (
                f"from {span[0]:.6g} s to the end nothing changes, and {output} leaps there by {amount(float(moves[-1]), output, step)}: "
                "the rig was switched off; left out"
            )
            yield Found(Finding("switched_off", name, None, *span, sentence, EXCLUDE, int(off.sum())), off)
            return


def _still_from(log: RunLog) -> int:
    """The row from which every input and every output is what it is in the last."""
    same = (log.u == log.u[-1]).all(axis=1) & ((log.y == log.y[-1]) | np.isnan(log.y)).all(axis=1)
    moving = np.flatnonzero(~same)
    return int(moving[-1]) + 1 if moving.size else 0


def _is_at_an_end(values: Array, value: float, least: float) -> bool:
    """Whether a value is the greatest or the least, where an axis may be stopped."""
    margin = thresholds.BROKEN_OFF_STEPS * least
    return not values.min() + margin < value < values.max() - margin


def _unanswered(values: Array, u: Array, begin: int) -> tuple[int, int]:
    """For how many rows the last stand, from `begin` on, leaves an input's move unanswered, 0 where none moves so far; and the most rows
    in which it answers elsewhere."""
    far = thresholds.MOVED_FAR * np.ptp(u, axis=0)
    if not np.any(far > 0.0):
        return 0, 0
    here = _moved_at(u[begin:], far)
    if here is None:
        return 0, 0
    asked = np.linspace(0, begin - 1, min(begin, thresholds.ROWS_ASKED)).astype(int) if begin else np.zeros(0, int)
    answers = [_answered_after(values[row:], u[row:], far) for row in asked.tolist()]
    known = [rows for rows in answers if rows is not None]
    return (len(values) - 1 - begin - here, max(known)) if len(known) >= thresholds.LEAST_ANSWERS else (0, 0)


def _answered_after(values: Array, u: Array, far: Array) -> int | None:
    """Rows from where an input has moved `far` (inputs,) to the output's first move, 0 where that is earlier; None where no input does."""
    moved = _moved_at(u, far)
    changed = np.flatnonzero(values != values[0])
    return None if moved is None or not changed.size else max(0, int(changed[0]) - moved)


def _moved_at(u: Array, far: Array) -> int | None:
    """The first row at which an input (n, inputs) is `far` (inputs,) from its first; None where none comes so far."""
    away: NDArray[np.bool_] = (np.abs(u - u[0]) >= np.where(far > 0.0, far, np.inf)).any(axis=1)
    return int(np.argmax(away)) if away.any() else None
