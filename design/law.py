"""The law in double precision, in delta form: the readable original of the generated C, with its names and argument order.

Per axis, with e0 = filtered reference - angle and its backward differences e1, e2, e3 (D.4 of docs/theory.md):

    v = v_prev - p_0 s_0 + p_1 s_1 + p_2 s_2 + p_3 s_3 + q_0 e0 + q_1 e1 + q_2 e2 + q_3 e3 - a_0 w_0 + a_1 w_1 + a_2 w_2
    u = v + u_ff(filtered elevation reference),   u_limited = limits(u),   w = u - u_limited,   s = v - w

where s_0 = s(k-1), s_1, s_2, s_3 are its backward differences, w_0, w_1, w_2 those of w, v_prev = v(k-1) = s_0 + w_0. Inserting
P = 1 - z^-1 [(1 - p_0) + p_1 delta + p_2 delta^2 + p_3 delta^3], A alike and v = s + w gives P s = Q e - A w, which is
A v = Q e + (A - P) s. Without a roll-off there is no p_3.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from records.table import PLAUSIBLE_V, AxisLaw, ControllerTable

Differences = tuple[float, ...]
_ZERO: Differences = (0.0, 0.0, 0.0)
_ZERO_OF_S: Differences = (*_ZERO, 0.0)


@dataclass(frozen=True)
class AxisState:
    """What one axis remembers: accepted inputs, prefilter x1 x2, v, and the last values and differences of e, s, w."""

    reference_rad: float
    angle_rad: float
    x1_rad: float
    x2_rad: float
    v_V: float = 0.0
    e: Differences = _ZERO
    s: Differences = _ZERO_OF_S
    w: Differences = _ZERO


@dataclass(frozen=True)
class LawState:
    """What the law remembers between two samples."""

    elevation: AxisState
    azimuth: AxisState


def law_reset(table: ControllerTable, psi_rad: float, phi_rad: float) -> LawState:
    """The state at rest at the measured angles; an angle that is not finite counts as 0.

    The filtered reference starts at the angle, or at the end of its range next to it; no difference of the error is pending.
    """
    return LawState(_axis_reset(table.elevation, psi_rad), _axis_reset(table.azimuth, phi_rad))


def _axis_reset(law: AxisLaw, angle_rad: float) -> AxisState:
    angle = _finite(angle_rad, 0.0)
    start = _clamp(angle, law.reference_min_rad, law.reference_max_rad)
    return AxisState(reference_rad=start, angle_rad=angle, x1_rad=start, x2_rad=start, e=(start - angle, 0.0, 0.0))


def law_step(
    table: ControllerTable,
    state: LawState,
    psi_ref_rad: float,
    phi_ref_rad: float,
    psi_rad: float,
    phi_rad: float,
) -> tuple[LawState, float, float]:
    """One sample: the new state and the inputs u_M_V and u_T_V; total, also for inputs that are not finite."""
    elevation = _filter(table.elevation, table.sample_period_s, state.elevation, psi_ref_rad, psi_rad)
    azimuth = _filter(table.azimuth, table.sample_period_s, state.azimuth, phi_ref_rad, phi_rad)
    psi_scheduled_rad = _clamp(elevation.angle_rad, table.psi_min_rad, table.psi_max_rad)
    elevation, u_M_V = _control(table.elevation, elevation, psi_scheduled_rad, elevation.x2_rad)
    azimuth, u_T_V = _control(table.azimuth, azimuth, psi_scheduled_rad, elevation.x2_rad)
    return LawState(elevation, azimuth), u_M_V, u_T_V


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


def _control(
    law: AxisLaw, state: AxisState, psi_scheduled_rad: float, elevation_reference_rad: float
) -> tuple[AxisState, float]:
    """Feedback, feed-forward, limits and anti-windup of one axis."""
    e = _differences(state.x2_rad - state.angle_rad, state.e)
    v = _feedback(law, state, e, psi_scheduled_rad)
    if not abs(v) <= PLAUSIBLE_V:  # only a broken state gets here: start the feedback afresh from the present error
        state, e, v = replace(state, s=_ZERO_OF_S, w=_ZERO), (e[0], 0.0, 0.0, 0.0), 0.0
    u = v + polynomial(law.feedforward_V, elevation_reference_rad)
    u_limited = saturate(law, u)
    w = u - u_limited
    remembered = replace(state, v_V=v, e=e[:3], s=_differences(v - w, state.s)[:4], w=_differences(w, state.w)[:3])
    return remembered, u_limited


def _feedback(law: AxisLaw, state: AxisState, e: Differences, psi_rad: float) -> float:
    q_0, q_1, q_2, q_3 = (polynomial(row, psi_rad) for row in law.q_V_rad)
    p_0, *p = (polynomial(row, psi_rad) for row in law.p)
    (a_0, a_1, a_2), (s_0, *s), (w_0, w_1, w_2) = law.a, state.s, state.w
    v = state.v_V - p_0 * s_0
    for p_i, s_i in zip(p, s, strict=False):  # without a roll-off there is no p_3
        v = v + p_i * s_i
    v = v + q_0 * e[0] + q_1 * e[1] + q_2 * e[2] + q_3 * e[3]
    return v - a_0 * w_0 + a_1 * w_1 + a_2 * w_2


def _differences(value: float, previous: Differences) -> Differences:
    """`value` with its backward differences of one order more than the last value's own in `previous`."""
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
        self._state = law_reset(table, 0.0, 0.0)

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Start at rest at the measured angles."""
        self._state = law_reset(self._table, psi_rad, phi_rad)

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]:
        """One sample: u_M_V, u_T_V."""
        self._state, u_M_V, u_T_V = law_step(self._table, self._state, psi_ref_rad, phi_ref_rad, psi_rad, phi_rad)
        return u_M_V, u_T_V
