"""The generated law, written once over any arithmetic: float32 scalars and lanes, exact rationals, intervals with errors.

Functions, names, and the order of every operation are those of templates/law.c.j2; an arithmetic gives the numbers and the
few decisions. The equations are those of records/table.py with w = v - s and w = u - limited(u):

    A v = Q e + (A - P) s,   A = 1 - z^-1 [(1 - a_0) + a_1 delta + a_2 delta^2],   P likewise with p_i
    A - P = z^-1 [(a_0 - p_0) + (p_1 - a_1) delta + (p_2 - a_2) delta^2]
    v = v(k-1) + Q e + z^-1 [-p_0 s + p_1 delta s + p_2 delta^2 s] + z^-1 [-a_0 w + a_1 delta w + a_2 delta^2 w]

so that with p_0 = 0 and no saturation v moves by Q e and past moves alone: the integrator is exact in any arithmetic.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, Generic, Protocol, TypeVar

from codegen.law_constants import AxisConstants, LawConstants

N = TypeVar("N")


class Arithmetic(Protocol[N]):
    """What the law asks of an arithmetic beyond + - *; a condition is whatever `choose` of the same arithmetic takes."""

    def finite_or(self, value: N, last: N) -> N:
        """`value` where it is finite, else `last` where that is finite, else zero."""

    def clamp(self, value: N, low: N, high: N) -> N:
        """`value` held within low..high; `value` is no NaN."""

    def saturate(self, value: N, low: N, high: N, safe: N) -> N:
        """`value` held within low..high, `safe` where it is NaN."""

    def settle(self, value: N, least: N) -> N:
        """`value`, or zero where |value| < least."""

    def is_plausible(self, value: N, bound: N) -> Any:
        """Condition |value| <= bound; false for NaN."""

    def choose(self, condition: Any, value: N, otherwise: N) -> N:
        """`value` where the condition holds, else `otherwise`."""


@dataclass(frozen=True)
class AxisState(Generic[N]):
    """What one axis remembers: filtered reference, differences of error, of s and of w (powers of delta), v."""

    reference_1_rad: N
    reference_2_rad: N
    e_0_rad: N
    e_1_rad: N
    e_2_rad: N
    v_V: N
    s_0_V: N
    s_1_V: N
    s_2_V: N
    w_0_V: N
    w_1_V: N
    w_2_V: N


@dataclass(frozen=True)
class LawState(Generic[N]):
    """Both axes and the last accepted measurements and references."""

    elevation: AxisState[N]
    azimuth: AxisState[N]
    psi_rad: N
    phi_rad: N
    psi_ref_rad: N
    phi_ref_rad: N


@dataclass(frozen=True)
class LawInput(Generic[N]):
    """References and measured angles of one step."""

    psi_ref_rad: N
    phi_ref_rad: N
    psi_rad: N
    phi_rad: N


@dataclass(frozen=True)
class LawOutput(Generic[N]):
    """Voltages of one step, within their limits."""

    u_M_V: N
    u_T_V: N


AXIS_STATE_FIELDS = tuple(field.name for field in fields(AxisState))
LAST_ACCEPTED_FIELDS = tuple(field.name for field in fields(LawState))[2:]
STATE_WORDS = 2 * len(AXIS_STATE_FIELDS) + len(LAST_ACCEPTED_FIELDS)


def state_from_words(words: Any) -> LawState[Any]:
    """A state from its numbers in the order of the C structure; `words[i]` is number i."""
    return state_of_words(words, AxisState)


def state_of_words(words: Any, axis_state: Callable[..., Any]) -> LawState[Any]:
    """The same for any law whose axes remember an `axis_state`, a dataclass of numbers."""
    count = len(fields(axis_state))  # type: ignore[arg-type]
    return LawState(
        axis_state(*(words[index] for index in range(count))),
        axis_state(*(words[index] for index in range(count, 2 * count))),
        *(words[index] for index in range(2 * count, 2 * count + len(LAST_ACCEPTED_FIELDS))),
    )


def words_from_state(state: LawState[N]) -> Iterator[N]:
    """The numbers of a state in the order of the C structure."""
    for axis in (state.elevation, state.azimuth):
        yield from (getattr(axis, field.name) for field in fields(axis))
    yield from (getattr(state, name) for name in LAST_ACCEPTED_FIELDS)


def law_reset(law: LawConstants[N], arithmetic: Arithmetic[N], psi_rad: N, phi_rad: N) -> LawState[N]:
    """The state at rest at these angles: the reference filters start there, the feedback at zero."""
    psi_rad = arithmetic.finite_or(psi_rad, law.zero)
    phi_rad = arithmetic.finite_or(phi_rad, law.zero)
    elevation = _axis_at_rest(law.elevation, law.zero, arithmetic, psi_rad)
    azimuth = _axis_at_rest(law.azimuth, law.zero, arithmetic, phi_rad)
    return LawState(elevation, azimuth, psi_rad, phi_rad, elevation.reference_2_rad, azimuth.reference_2_rad)


def law_step(
    law: LawConstants[N], arithmetic: Arithmetic[N], state: LawState[N], given: LawInput[N]
) -> tuple[LawState[N], LawOutput[N]]:
    """One sample of both axes: the new state and the limited voltages."""
    psi_rad = arithmetic.finite_or(given.psi_rad, state.psi_rad)
    phi_rad = arithmetic.finite_or(given.phi_rad, state.phi_rad)
    psi_ref_rad = arithmetic.finite_or(given.psi_ref_rad, state.psi_ref_rad)
    phi_ref_rad = arithmetic.finite_or(given.phi_ref_rad, state.phi_ref_rad)
    schedule_rad = arithmetic.settle(
        arithmetic.clamp(psi_rad, law.psi_min_rad, law.psi_max_rad), law.least_schedule_rad
    )

    elevation = prefilter(law.elevation, arithmetic, state.elevation, psi_ref_rad)
    azimuth = prefilter(law.azimuth, arithmetic, state.azimuth, phi_ref_rad)
    u_M_ff_V = polynomial(law.elevation.feedforward_V, elevation.reference_2_rad, law.zero)
    u_T_ff_V = polynomial(law.azimuth.feedforward_V, elevation.reference_2_rad, law.zero)

    e_psi = differences(elevation, psi_rad)
    e_phi = differences(azimuth, phi_rad)
    v_M_V = elevation.v_V + move(law.elevation, elevation, e_psi, schedule_rad)
    v_T_V = azimuth.v_V + move(law.azimuth, azimuth, e_phi, schedule_rad)
    elevation, u_M_V = drive(law, law.elevation, arithmetic, elevation, e_psi, v_M_V, u_M_ff_V)
    azimuth, u_T_V = drive(law, law.azimuth, arithmetic, azimuth, e_phi, v_T_V, u_T_ff_V)
    return LawState(elevation, azimuth, psi_rad, phi_rad, psi_ref_rad, phi_ref_rad), LawOutput(u_M_V, u_T_V)


def prefilter(axis: AxisConstants[N], arithmetic: Arithmetic[N], state: AxisState[N], reference_rad: N) -> AxisState[N]:
    """1/(T s + 1)^2 as two one-poles; both stay within the reference's range, so a broken state heals at once."""
    low_rad, high_rad = axis.reference_min_rad, axis.reference_max_rad
    target_rad: Any = arithmetic.clamp(reference_rad, low_rad, high_rad)
    if axis.prefilter_gain is None:
        return replace(state, reference_1_rad=target_rad, reference_2_rad=target_rad)
    first_rad: Any = state.reference_1_rad
    first_rad = first_rad + axis.prefilter_gain * (target_rad - first_rad)
    first_rad = arithmetic.saturate(first_rad, low_rad, high_rad, target_rad)
    second_rad: Any = state.reference_2_rad
    second_rad = second_rad + axis.prefilter_gain * (first_rad - second_rad)
    second_rad = arithmetic.saturate(second_rad, low_rad, high_rad, target_rad)
    return replace(state, reference_1_rad=first_rad, reference_2_rad=second_rad)


def differences(state: AxisState[Any], angle_rad: Any) -> tuple[Any, Any, Any, Any]:
    """Error e and delta e, delta^2 e, delta^3 e."""
    e_0_rad = state.reference_2_rad - angle_rad
    e_1_rad = e_0_rad - state.e_0_rad
    e_2_rad = e_1_rad - state.e_1_rad
    e_3_rad = e_2_rad - state.e_2_rad
    return e_0_rad, e_1_rad, e_2_rad, e_3_rad


def move(axis: AxisConstants[Any], state: AxisState[Any], e_rad: tuple[Any, ...], schedule_rad: Any) -> Any:
    """Change of v: Q e - p_0 s + p_1 delta s + p_2 delta^2 s - a_0 w + a_1 delta w + a_2 delta^2 w, from left to right."""
    s_V = (state.s_0_V, state.s_1_V, state.s_2_V)
    w_V = (state.w_0_V, state.w_1_V, state.w_2_V)
    terms = [(c, e, +1) for c, e in zip(axis.q_V_rad, e_rad, strict=True)]
    terms += [(c, s, sign) for c, s, sign in zip(axis.p, s_V, (-1, +1, +1), strict=True)]
    terms += [(c, w, sign) for c, w, sign in zip(axis.a, w_V, (-1, +1, +1), strict=True)]
    products = [(polynomial(c, schedule_rad, None) * x, sign) for c, x, sign in terms if c]
    move_V = products[0][0]
    for product_V, sign in products[1:]:
        move_V = move_V + product_V if sign > 0 else move_V - product_V
    return move_V


def drive(
    law: LawConstants[N],
    axis: AxisConstants[N],
    arithmetic: Arithmetic[N],
    state: AxisState[Any],
    e_rad: tuple[Any, ...],
    v_V: Any,
    u_ff_V: Any,
) -> tuple[AxisState[Any], N]:
    """From v to the limited voltage; returns what the axis remembers, and the voltage."""
    plausible = arithmetic.is_plausible(v_V, law.plausible_V)

    # A broken state must not live on in the differences: all but the present error is forgotten.
    def kept(value: Any) -> Any:
        return arithmetic.choose(plausible, value, law.zero)

    v_V = kept(v_V)
    u_V = v_V + u_ff_V
    limited_V: Any = arithmetic.saturate(u_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)
    w_0_V = u_V - limited_V
    w_1_V = w_0_V - kept(state.w_0_V)
    w_2_V = w_1_V - kept(state.w_1_V)
    s_0_V = v_V - w_0_V
    s_1_V = s_0_V - kept(state.s_0_V)
    s_2_V = s_1_V - kept(state.s_1_V)
    remembered = AxisState(
        reference_1_rad=state.reference_1_rad,
        reference_2_rad=state.reference_2_rad,
        e_0_rad=e_rad[0],
        e_1_rad=kept(e_rad[1]),
        e_2_rad=kept(e_rad[2]),
        v_V=v_V,
        s_0_V=s_0_V,
        s_1_V=s_1_V,
        s_2_V=s_2_V,
        w_0_V=w_0_V,
        w_1_V=w_1_V,
        w_2_V=w_2_V,
    )
    return remembered, limited_V


def polynomial(coefficients: tuple[N, ...], x: N, zero: N) -> Any:
    """((c_n x + ...) x + c_1) x + c_0 by Horner; zero for no coefficients."""
    if not coefficients:
        return zero
    value: Any = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        value = value * x + coefficient
    return value


def _axis_at_rest(axis: AxisConstants[N], zero: N, arithmetic: Arithmetic[N], angle_rad: N) -> AxisState[N]:
    reference_rad: Any = arithmetic.clamp(angle_rad, axis.reference_min_rad, axis.reference_max_rad)
    at_zero = AxisState(*(zero for _ in AXIS_STATE_FIELDS))
    return replace(
        at_zero, reference_1_rad=reference_rad, reference_2_rad=reference_rad, e_0_rad=reference_rad - angle_rad
    )
