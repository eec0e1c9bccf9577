"""The law of records/table.py on any tool's numbers, for peers that compile it together with the plant."""

from typing import Any

import numpy as np

from records.table import AxisLaw, ControllerTable
from sim.bind import BoundPlant
from sim.manoeuvres import Manoeuvre

LAW_STATES = 13  # per axis: two prefilter states, v, and e, s, w with their differences: 3, 4, 3


class PlainNumbers:
    """What the law asks of Python's own numbers."""

    minimum, maximum = min, max


def law_step(table: ControllerTable, ops: Any, state: Any, reference: Any, y: Any) -> tuple[list[Any], list[Any]]:
    """One sample of the law: `ops` has `minimum` and `maximum`; returns the new state and the inputs."""
    new: list[Any] = []
    u: list[Any] = []
    schedule = table.schedule
    assert schedule is not None
    psi = ops.maximum(ops.minimum(y[0], schedule.max_rad), schedule.min_rad)
    filtered = None
    for place, axis in enumerate(table.axes):
        own = [state[place * LAW_STATES + index] for index in range(LAW_STATES)]
        x1, x2 = _prefilter(axis, table.sample_period_s, own, reference[place])
        filtered = x2 if filtered is None else filtered
        remembered, command = _axis_step(axis, ops, own, psi, x2 - y[place], _polynomial(axis.feedforward_V, filtered))
        new += [x1, x2, *remembered]
        u.append(command)
    return new, u


def _prefilter(axis: AxisLaw, period_s: float, own: list[Any], reference: Any) -> tuple[Any, Any]:
    gain = axis.prefilter_gain(period_s)
    x1 = own[0] + gain * (reference - own[0])
    return x1, own[1] + gain * (x1 - own[1])


def _axis_step(
    axis: AxisLaw, ops: Any, own: list[Any], psi: Any, error: Any, feedforward: Any
) -> tuple[list[Any], Any]:
    v, e, s, w = own[2], own[3:6], own[6:10], own[10:13]
    q, p = ([_polynomial(row, psi) for row in rows] for rows in (axis.q_V_rad, axis.p))
    e_new = _differences(error, e)
    v = v - p[0] * s[0] + sum(p[i] * s[i] for i in range(1, len(p))) + sum(q[i] * e_new[i] for i in range(4))
    v = v - axis.a[0] * w[0] + axis.a[1] * w[1] + axis.a[2] * w[2]
    limited = ops.maximum(ops.minimum(v + feedforward, axis.u_max_V), axis.u_min_V)
    excess = v + feedforward - limited
    return [v, *e_new[:3], *_differences(v - excess, s)[:4], *_differences(excess, w)[:3]], limited


def _differences(value: Any, previous: list[Any]) -> list[Any]:
    result = [value]
    for last in previous:
        result.append(result[-1] - last)
    return result


def _polynomial(coefficients: tuple[float, ...], argument: Any) -> Any:
    result = 0.0 * argument
    for coefficient in reversed(coefficients):
        result = result * argument + coefficient
    return result


def law_start(bound: BoundPlant, manoeuvre: Manoeuvre) -> np.ndarray:
    """The law's state at rest at the first angles."""
    rows = [bound.model.states.index(output) for output in bound.model.outputs.values()]
    state = np.zeros(2 * LAW_STATES)
    for place, row in enumerate(rows):
        state[place * LAW_STATES : place * LAW_STATES + 2] = manoeuvre.x0[row]
    return state
