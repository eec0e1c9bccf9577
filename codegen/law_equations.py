"""The scheduled law's own equations, written once over any arithmetic: float32 scalars and lanes, exact rationals, intervals with errors.

Functions, names, and the order of every operation are those of templates/law.c.j2; what all laws share is law_frame.py. The
equations are those of records/table.py with w = v - s and w = u - limited(u):

    A v = Q e + (A - P) s,   A = 1 - z^-1 [(1 - a_0) + a_1 delta + a_2 delta^2 + ..],   P likewise with p_i
    A - P = z^-1 [(a_0 - p_0) + (p_1 - a_1) delta + (p_2 - a_2) delta^2 + ..]
    v = v(k-1) + Q e + z^-1 [-p_0 s + p_1 delta s + p_2 delta^2 s + ..] + z^-1 [-a_0 w + a_1 delta w + a_2 delta^2 w + ..]

so that with p_0 = 0 and no saturation v moves by Q e and past moves alone: the integrator is exact in any arithmetic.
"""

from collections.abc import Iterable, Sequence
from dataclasses import make_dataclass, replace
from functools import cache
from typing import Any, TypeVar

from codegen import law_frame
from codegen.law_constants import AxisConstants, LawConstants
from codegen.law_frame import Arithmetic, LawInput, LawState, Sample, polynomial, state_of_words, state_size
from records.table import ControllerTable

N = TypeVar("N")


@cache
def axis_state(order: int, feedback: str = "v_V") -> Any:
    """The record of what an axis of `order` states remembers: filtered reference, differences of the error, v, differences of s and w.

    The index is the power of delta; E, S and W are the names of each kind.
    """
    e, s, w = (
        tuple(f"{letter}_{power}_{unit}" for power in range(count))
        for letter, unit, count in (("e", "rad", order), ("s", "V", order + 1), ("w", "V", order))
    )
    names = ("reference_1_rad", "reference_2_rad", *e, feedback, *s, *w)
    return make_dataclass("AxisState", names, frozen=True, namespace={"E": e, "S": s, "W": w})


def state_words(table: ControllerTable) -> int:
    """Numbers of the law's state."""
    return state_size(axis_state(table.order), len(table.loops))


def state_from_words(table: ControllerTable, words: Any) -> LawState[Any]:
    """A state from its numbers in the order of the C structure; `words[i]` is number i."""
    return state_of_words(words, axis_state(table.order), len(table.loops))


def law_reset(law: LawConstants[N], arithmetic: Arithmetic[N], angles_rad: Sequence[N]) -> LawState[N]:
    """The state at rest at these angles: the reference filters start there, the feedback at zero."""
    return law_frame.law_reset(scheduled_law(law.order), law, arithmetic, angles_rad)


def law_step(
    law: LawConstants[N], arithmetic: Arithmetic[N], state: LawState[N], given: LawInput[N]
) -> tuple[LawState[N], tuple[N, ...]]:
    """One sample of all axes: the new state and the limited voltages."""
    return law_frame.law_step(scheduled_law(law.order), law, arithmetic, state, given)


class Scheduled:
    """The axis' equations in the frame; `AxisState` is the record of what an axis of `order` states remembers."""

    def __init__(self, order: int) -> None:
        self.AxisState = axis_state(order)

    def axis_rest(
        self, law: Any, axis: Any, arithmetic: Any, reference_rad: Any, angle_rad: Any, schedule_rad: Any
    ) -> Any:
        """The error as it is, everything else at zero."""
        at_zero = self.AxisState(*(law.zero for _ in self.AxisState.__dataclass_fields__))
        return replace(
            at_zero, reference_1_rad=reference_rad, reference_2_rad=reference_rad, e_0_rad=reference_rad - angle_rad
        )

    def axis_step(self, law: Any, axis: Any, arithmetic: Any, state: Any, sample: Sample[Any]) -> tuple[Any, Any]:
        """Differences of the error, v, the limits."""
        e_rad = differences(state, sample.angle_rad)
        v_V = state.v_V + move(axis, state, e_rad, sample.schedule_rad)
        return drive(law, axis, arithmetic, state, e_rad, v_V, sample.u_ff_V)


@cache
def scheduled_law(order: int) -> Scheduled:
    """The equations for axes of `order` states."""
    return Scheduled(order)


def differences(state: Any, angle_rad: Any) -> tuple[Any, ...]:
    """Error e and delta e, delta^2 e and so on, one more than are remembered."""
    return differenced(state.reference_2_rad - angle_rad, (getattr(state, name) for name in state.E))


def differenced(value: Any, previous: Iterable[Any]) -> tuple[Any, ...]:
    """`value` and its backward differences, given those of the sample before."""
    found = [value]
    for last in previous:
        found.append(found[-1] - last)
    return tuple(found)


def move(axis: AxisConstants[Any], state: Any, e_rad: tuple[Any, ...], schedule_rad: Any) -> Any:
    """Change of v with the polynomials of the table at this angle; terms that are zero for every Psi are left out."""

    def at(polynomials: tuple[tuple[Any, ...], ...]) -> list[Any]:
        return [polynomial(c, schedule_rad, None) if c else None for c in polynomials]

    return moved(state, e_rad, at(axis.q_V_rad), at(axis.p), at(axis.a))


def moved(state: Any, e_rad: tuple[Any, ...], q_V_rad: Sequence[Any], p: Sequence[Any], a: Sequence[Any]) -> Any:
    """Q e - p_0 s + p_1 delta s + .. - a_0 w + a_1 delta w + .., from left to right.

    None leaves a term out; an axis may have fewer coefficients than the state has differences.
    """
    terms = [(c, e, True) for c, e in zip(q_V_rad, e_rad, strict=False)]
    for coefficients, names in ((p, state.S), (a, state.W)):
        pairs = zip(coefficients, names, strict=False)
        terms += [(c, getattr(state, name), index > 0) for index, (c, name) in enumerate(pairs)]
    products = [(c * x, is_added) for c, x, is_added in terms if c is not None]
    move_V = products[0][0]
    for product_V, is_added in products[1:]:
        move_V = move_V + product_V if is_added else move_V - product_V
    return move_V


def drive(
    law: law_frame.LawNumbers[N],
    axis: law_frame.AxisFrame[N],
    arithmetic: Arithmetic[N],
    state: Any,
    e_rad: tuple[Any, ...],
    v_V: Any,
    u_ff_V: Any,
) -> tuple[Any, N]:
    """From v to the limited voltage; returns what the axis remembers, and the voltage."""
    plausible = arithmetic.is_plausible(v_V, law.plausible_V)

    # A broken state must not live on in the differences: all but the present error is forgotten.
    def kept(value: Any) -> Any:
        return arithmetic.choose(plausible, value, law.zero)

    def moved_on(value: Any, names: tuple[str, ...]) -> dict[str, Any]:
        return dict(zip(names, differenced(value, [kept(getattr(state, name)) for name in names[:-1]]), strict=True))

    v_V = kept(v_V)
    u_V = v_V + u_ff_V
    limited_V: Any = arithmetic.saturate(u_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)
    w_V = u_V - limited_V
    errors = dict(zip(state.E, (e_rad[0], *map(kept, e_rad[1:-1])), strict=True))
    return replace(state, v_V=v_V, **errors, **moved_on(v_V - w_V, state.S), **moved_on(w_V, state.W)), limited_V
