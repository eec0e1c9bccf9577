"""The law in double precision, in delta form: the readable original of the generated C, with its names and argument order.

Per axis of n states, with e0 = filtered reference - angle and its backward differences e1, e2 .. en (D.4 of docs/theory.md):

    v = v_prev - p_0 s_0 + p_1 s_1 + .. + q_0 e0 + q_1 e1 + .. + q_n en - a_0 w_0 + a_1 w_1 + ..
    u = v + u_ff(filtered reference of the scheduling angle),   u_limited = limits(u),   w = u - u_limited,   s = v - w

where s_0 = s(k-1), s_1, s_2 .. are its backward differences, w_0, w_1 .. those of w, v_prev = v(k-1) = s_0 + w_0. Inserting
P = 1 - z^-1 [(1 - p_0) + p_1 delta + .. + p_n delta^n], A alike and v = s + w gives P s = Q e - A w, which is
A v = Q e + (A - P) s. Without a roll-off there is no p_n.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from records.table import PLAUSIBLE_V, AxisLaw, ControllerTable

Differences = tuple[float, ...]


@dataclass(frozen=True)
class AxisState:
    """What one axis remembers: accepted inputs, prefilter x1 x2, v, and the last values and differences of e, s, w."""

    reference_rad: float
    angle_rad: float
    x1_rad: float
    x2_rad: float
    v_V: float
    e: Differences
    s: Differences
    w: Differences


LawState = tuple[AxisState, ...]


def law_reset(table: ControllerTable, *angles_rad: float) -> LawState:
    """The state at rest at the measured angles; an angle that is not finite counts as 0.

    The filtered reference starts at the angle, or at the end of its range next to it; no difference of the error is pending.
    """
    return tuple(_axis_reset(law, angle_rad) for law, angle_rad in zip(table.axes, angles_rad, strict=True))


def _axis_reset(law: AxisLaw, angle_rad: float) -> AxisState:
    angle = _finite(angle_rad, 0.0)
    start = _clamp(angle, law.reference_min_rad, law.reference_max_rad)
    zeros = (0.0,) * law.order
    return AxisState(start, angle, start, start, v_V=0.0, e=(start - angle, *zeros[1:]), s=(*zeros, 0.0), w=zeros)


def law_step(table: ControllerTable, state: LawState, *given_rad: float) -> tuple[LawState, tuple[float, ...]]:
    """One sample of references, then angles: the new state and the voltages; total, also for inputs that are not finite."""
    references_rad, angles_rad = given_rad[: len(table.axes)], given_rad[len(table.axes) :]
    accepted = [
        _filter(law, table.sample_period_s, remembered, reference_rad, angle_rad)
        for law, remembered, reference_rad, angle_rad in zip(table.axes, state, references_rad, angles_rad, strict=True)
    ]
    scheduled_rad, region_rad = _schedule(table, accepted)
    stepped = [_control(law, own, scheduled_rad, region_rad) for law, own in zip(table.axes, accepted, strict=True)]
    return tuple(own for own, _ in stepped), tuple(u_V for _, u_V in stepped)


def _schedule(table: ControllerTable, accepted: Sequence[AxisState]) -> tuple[float, float]:
    """The scheduling angle within its range, and its filtered reference; zeros without a schedule."""
    schedule = table.schedule
    if schedule is None:
        return 0.0, 0.0
    own = accepted[table.index(schedule.axis)]
    return _clamp(own.angle_rad, schedule.min_rad, schedule.max_rad), own.x2_rad


def _filter(
    law: AxisLaw, sample_period_s: float, state: AxisState, reference_rad: float, angle_rad: float
) -> AxisState:
    """Accept finite inputs; the reference, within its range, passes 1/(T s + 1)^2 as two one-poles."""
    reference = _finite(reference_rad, state.reference_rad)
    target = _clamp(reference, law.reference_min_rad, law.reference_max_rad)
    b = law.prefilter_gain(sample_period_s)
    x1 = _within_reference(law, state.x1_rad + b * (target - state.x1_rad), target)
    x2 = _within_reference(law, state.x2_rad + b * (x1 - state.x2_rad), target)
    angle = _finite(angle_rad, state.angle_rad)
    return replace(state, reference_rad=reference, angle_rad=angle, x1_rad=x1, x2_rad=x2)


def _within_reference(law: AxisLaw, x_rad: float, target_rad: float) -> float:
    """x of the prefilter, which lies within the reference's range of itself; a broken one becomes the target."""
    return target_rad if math.isnan(x_rad) else _clamp(x_rad, law.reference_min_rad, law.reference_max_rad)


def _control(law: AxisLaw, state: AxisState, scheduled_rad: float, region_rad: float) -> tuple[AxisState, float]:
    """Feedback, feed-forward, limits and anti-windup of one axis."""
    e = _differences(state.x2_rad - state.angle_rad, state.e)
    v = _feedback(law, state, e, scheduled_rad)
    if not abs(v) <= PLAUSIBLE_V:  # only a broken state gets here: start the feedback afresh from the present error
        zeros = (0.0,) * law.order
        state, e, v = replace(state, s=(*zeros, 0.0), w=zeros), (e[0], *zeros), 0.0
    u = v + polynomial(law.feedforward_V, region_rad)
    u_limited = saturate(law, u)
    w = u - u_limited
    s, w_differences = _differences(v - w, state.s[:-1]), _differences(w, state.w[:-1])
    return replace(state, v_V=v, e=e[:-1], s=s, w=w_differences), u_limited


def _feedback(law: AxisLaw, state: AxisState, e: Differences, psi_rad: float) -> float:
    q, p = ([polynomial(row, psi_rad) for row in rows] for rows in (law.q_V_rad, law.p))
    v = state.v_V - p[0] * state.s[0]
    for p_i, s_i in zip(p[1:], state.s[1:], strict=False):  # without a roll-off there is no p_n
        v = v + p_i * s_i
    for q_i, e_i in zip(q, e, strict=True):
        v = v + q_i * e_i
    v = v - law.a[0] * state.w[0]
    for a_i, w_i in zip(law.a[1:], state.w[1:], strict=True):
        v = v + a_i * w_i
    return v


def _differences(value: float, previous: Differences) -> Differences:
    """`value` with its backward differences, one for each of those of the last value in `previous`."""
    found = [value]
    for last in previous:
        found.append(found[-1] - last)
    return tuple(found)


def polynomial(coefficients: Sequence[float], argument: float) -> float:
    """sum_i c_i argument^i by Horner's rule, from the highest power down."""
    result = 0.0
    for coefficient in reversed(coefficients):
        result = result * argument + coefficient
    return result


def saturate(law: AxisLaw, u_V: float) -> float:
    """u within the limits; the safe voltage where u is not a number."""
    return law.u_safe_V if math.isnan(u_V) else _clamp(u_V, law.u_min_V, law.u_max_V)


def _finite(value: float, last: float) -> float:
    """`value` where it is finite, else the last one accepted, else 0."""
    return value if math.isfinite(value) else last if math.isfinite(last) else 0.0


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


class FloatLaw:
    """The law behind the interface of the closed loop: `reset`, then `step` once a sample."""

    def __init__(self, table: ControllerTable) -> None:
        self._table = table
        self._state = law_reset(table, *[0.0] * len(table.axes))

    def reset(self, *angles_rad: float) -> None:
        """Start at rest at the measured angles."""
        self._state = law_reset(self._table, *angles_rad)

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """One sample of references, then angles: the voltages."""
        self._state, voltages_V = law_step(self._table, self._state, *given_rad)
        return voltages_V
