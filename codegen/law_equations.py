"""The scheduled law's own equations, written once over any arithmetic: float32 scalars and lanes, exact rationals, intervals with errors.

Functions, names, and the order of every operation are those of templates/law.c.j2; what all laws share is law_frame.py. The
equations are those of records/table.py with w = v - s and w = u - limited(u):

    A v = Q e + (A - P) s,   A = 1 - z^-1 [(1 - a_0) + a_1 delta + a_2 delta^2],   P likewise with p_i
    A - P = z^-1 [(a_0 - p_0) + (p_1 - a_1) delta + (p_2 - a_2) delta^2]
    v = v(k-1) + Q e + z^-1 [-p_0 s + p_1 delta s + p_2 delta^2 s] + z^-1 [-a_0 w + a_1 delta w + a_2 delta^2 w]

so that with p_0 = 0 and no saturation v moves by Q e and past moves alone: the integrator is exact in any arithmetic.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Generic, TypeVar

from codegen import law_frame
from codegen.law_constants import AxisConstants, LawConstants
from codegen.law_frame import (
    LAST_ACCEPTED_FIELDS,
    Arithmetic,
    LawInput,
    LawOutput,
    LawState,
    Sample,
    polynomial,
    prefilter,
    state_of_words,
    words_from_state,
)

__all__ = [
    "AXIS_STATE_FIELDS",
    "LAST_ACCEPTED_FIELDS",
    "SCHEDULED",
    "STATE_WORDS",
    "Arithmetic",
    "AxisState",
    "LawInput",
    "LawOutput",
    "LawState",
    "Scheduled",
    "differences",
    "drive",
    "law_reset",
    "law_step",
    "move",
    "moved",
    "polynomial",
    "prefilter",
    "state_from_words",
    "state_of_words",
    "words_from_state",
]

N = TypeVar("N")


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


AXIS_STATE_FIELDS = tuple(field.name for field in fields(AxisState))
STATE_WORDS = 2 * len(AXIS_STATE_FIELDS) + len(LAST_ACCEPTED_FIELDS)


def state_from_words(words: Any) -> LawState[Any]:
    """A state from its numbers in the order of the C structure; `words[i]` is number i."""
    return state_of_words(words, AxisState)


def law_reset(law: LawConstants[N], arithmetic: Arithmetic[N], psi_rad: N, phi_rad: N) -> LawState[N]:
    """The state at rest at these angles: the reference filters start there, the feedback at zero."""
    return law_frame.law_reset(SCHEDULED, law, arithmetic, psi_rad, phi_rad)


def law_step(
    law: LawConstants[N], arithmetic: Arithmetic[N], state: LawState[N], given: LawInput[N]
) -> tuple[LawState[N], LawOutput[N]]:
    """One sample of both axes: the new state and the limited voltages."""
    return law_frame.law_step(SCHEDULED, law, arithmetic, state, given)


class Scheduled:
    """The axis' equations in the frame; `AxisState` below is the record of that name."""

    AxisState = AxisState

    def axis_rest(
        self, law: Any, axis: Any, arithmetic: Any, reference_rad: Any, angle_rad: Any, schedule_rad: Any
    ) -> Any:
        """The error as it is, everything else at zero."""
        at_zero = self.AxisState(*(law.zero for _ in AXIS_STATE_FIELDS))
        return replace(
            at_zero, reference_1_rad=reference_rad, reference_2_rad=reference_rad, e_0_rad=reference_rad - angle_rad
        )

    def axis_step(self, law: Any, axis: Any, arithmetic: Any, state: Any, sample: Sample[Any]) -> tuple[Any, Any]:
        """Differences of the error, v, the limits."""
        e_rad = differences(state, sample.angle_rad)
        v_V = state.v_V + move(axis, state, e_rad, sample.schedule_rad)
        return drive(law, axis, arithmetic, state, e_rad, v_V, sample.u_ff_V)


SCHEDULED = Scheduled()


def differences(state: AxisState[Any], angle_rad: Any) -> tuple[Any, Any, Any, Any]:
    """Error e and delta e, delta^2 e, delta^3 e."""
    e_0_rad = state.reference_2_rad - angle_rad
    e_1_rad = e_0_rad - state.e_0_rad
    e_2_rad = e_1_rad - state.e_1_rad
    e_3_rad = e_2_rad - state.e_2_rad
    return e_0_rad, e_1_rad, e_2_rad, e_3_rad


def move(axis: AxisConstants[Any], state: AxisState[Any], e_rad: tuple[Any, ...], schedule_rad: Any) -> Any:
    """Change of v with the polynomials of the table at this elevation; terms that are zero for every Psi are left out."""

    def at(polynomials: tuple[tuple[Any, ...], ...]) -> list[Any]:
        return [polynomial(c, schedule_rad, None) if c else None for c in polynomials]

    return moved(state, e_rad, at(axis.q_V_rad), at(axis.p), at(axis.a))


def moved(
    state: AxisState[Any], e_rad: tuple[Any, ...], q_V_rad: Sequence[Any], p: Sequence[Any], a: Sequence[Any]
) -> Any:
    """Q e - p_0 s + p_1 delta s + p_2 delta^2 s - a_0 w + a_1 delta w + a_2 delta^2 w, from left to right; None leaves a term out."""
    s_V = (state.s_0_V, state.s_1_V, state.s_2_V)
    w_V = (state.w_0_V, state.w_1_V, state.w_2_V)
    terms = [(c, e, +1) for c, e in zip(q_V_rad, e_rad, strict=True)]
    terms += [(c, s, sign) for c, s, sign in zip(p, s_V, (-1, +1, +1), strict=True)]
    terms += [(c, w, sign) for c, w, sign in zip(a, w_V, (-1, +1, +1), strict=True)]
    products = [(c * x, sign) for c, x, sign in terms if c is not None]
    move_V = products[0][0]
    for product_V, sign in products[1:]:
        move_V = move_V + product_V if sign > 0 else move_V - product_V
    return move_V


def drive(
    law: law_frame.LawNumbers[N],
    axis: law_frame.AxisFrame[N],
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
