"""The fixed-point law, written once over words: integers, lanes of integers, intervals, or numbers that carry their error.

Functions, names and order of operations are those of templates/law_fixed.c.j2, and the equations those of law_equations.py:

    v = v(k-1) + Q e + z^-1 [-p_0 s + p_1 delta s + p_2 delta^2 s + p_3 delta^3 s] + z^-1 [-a_0 w + a_1 delta w + a_2 delta^2 w]

with v(k-1) = s + w. All differences are exact; the products are summed exactly, and what the sum has below the last place of v
is carried to the next sample, so that rounding never adds up. A broken state is taken modulo the range of each word: the law goes
on from a bounded one, and forgets it as it forgets any disturbance.
"""

from dataclasses import dataclass, fields, replace
from typing import Any, Generic, TypeVar

from codegen.fixed.arithmetic import Words
from codegen.fixed.constants import FixedAxis, FixedLaw, FixedPolynomial
from codegen.fixed.formats import FILTERED_BITS
from codegen.law_frame import LawInput, LawOutput, LawState, state_of_words

N = TypeVar("N")


@dataclass(frozen=True)
class AxisState(Generic[N]):
    """What one axis remembers, as law_equations.AxisState; in place of v = s + w stands what its sum has below the last place."""

    reference_1_rad: N
    reference_2_rad: N
    e_0_rad: N
    e_1_rad: N
    e_2_rad: N
    v_residue: N
    s_0_V: N
    s_1_V: N
    s_2_V: N
    s_3_V: N
    w_0_V: N
    w_1_V: N
    w_2_V: N


AXIS_STATE_FIELDS = tuple(field.name for field in fields(AxisState))


def state_from_words(words: Any) -> LawState[Any]:
    """A state from its words in the order of the C structure; `words[i]` is word i."""
    return state_of_words(words, AxisState)


def law_reset(law: FixedLaw[Any], words: Words[Any], psi_rad: Any, phi_rad: Any) -> LawState[Any]:
    """The state at rest at these angles: the reference filters start there, the feedback at zero."""
    psi_rad = held_angle(law, words, psi_rad, law.zero)
    phi_rad = held_angle(law, words, phi_rad, law.zero)
    elevation, psi_ref_rad = _axis_at_rest(law, law.elevation, words, psi_rad)
    azimuth, phi_ref_rad = _axis_at_rest(law, law.azimuth, words, phi_rad)
    return LawState(elevation, azimuth, psi_rad, phi_rad, psi_ref_rad, phi_ref_rad)


def law_step(
    law: FixedLaw[Any], words: Words[Any], state: LawState[Any], given: LawInput[Any]
) -> tuple[LawState[Any], LawOutput[Any]]:
    """One sample of both axes: the new state and the limited voltages."""
    psi_rad = held_angle(law, words, given.psi_rad, state.psi_rad)
    phi_rad = held_angle(law, words, given.phi_rad, state.phi_rad)
    psi_ref_rad = words.accepted(given.psi_ref_rad, state.psi_ref_rad)
    phi_ref_rad = words.accepted(given.phi_ref_rad, state.phi_ref_rad)
    psi = schedule(law, words, psi_rad)

    psi_filtered = prefilter(law, law.elevation, words, state.elevation, psi_ref_rad)
    phi_filtered = prefilter(law, law.azimuth, words, state.azimuth, phi_ref_rad)
    psi_ref = powers_of(law, words, psi_filtered[1] * 2**law.reference_doublings)
    u_M_ff_V = polynomial(law.elevation.feedforward_V, words, psi_ref, "elevation.u_ff_V")
    u_T_ff_V = polynomial(law.azimuth.feedforward_V, words, psi_ref, "azimuth.u_ff_V")

    elevation, u_M_V = step_axis(law, law.elevation, words, state.elevation, psi_filtered, psi_rad, psi, u_M_ff_V)
    azimuth, u_T_V = step_axis(law, law.azimuth, words, state.azimuth, phi_filtered, phi_rad, psi, u_T_ff_V)
    return LawState(elevation, azimuth, psi_rad, phi_rad, psi_ref_rad, phi_ref_rad), LawOutput(u_M_V, u_T_V)


def held_angle(law: FixedLaw[Any], words: Words[Any], angle_rad: Any, last_rad: Any) -> Any:
    """The angle, or the last one where it is missing, held within the limit that the formats are made for."""
    return words.held(words.accepted(angle_rad, last_rad), law.angle_min_rad, law.angle_max_rad)


def schedule(law: FixedLaw[Any], words: Words[Any], psi_rad: Any) -> tuple[Any, ...]:
    """Powers of psi within the schedule's range."""
    psi_rad = words.clamp(psi_rad, law.psi_min_rad, law.psi_max_rad)
    return powers_of(law, words, psi_rad * 2**law.schedule_doublings)


def powers_of(law: FixedLaw[Any], words: Words[Any], x_1: Any) -> tuple[Any, ...]:
    """x, x^2, x^3 ... of an angle that has as many places as it has room for; x^i has i times as many bits before the point."""
    powers = [words.word("x_1", x_1)]
    for index in range(1, law.degree):
        powers.append(words.word(f"x_{index + 1}", words.scaled(powers[-1], x_1) * 2))
    return tuple(powers)


def polynomial(p: FixedPolynomial[Any], words: Words[Any], powers: tuple[Any, ...], name: str) -> Any:
    """c_0 + c_1 x + c_2 x^2 + ... of the powers that count."""
    value = p.constant
    for part in p.powers:
        x = powers[part.power - 1]
        if part.products == 3:
            term = words.word(name, words.scaled(part.coefficient, x) * 2**part.shift)
        elif part.products == 2:
            term = words.floored(words.scaled_short(part.coefficient, x), part.shift)
        else:
            product = words.word("a product of halves", part.coefficient * words.floored(x, 16))
            term = words.floored(product, part.shift)
        value = words.word(name, value + term)
    return words.word(name, value)


def held_reference(law: FixedLaw[Any], axis: FixedAxis[Any], words: Words[Any], reference_rad: Any) -> Any:
    """The reference, any word, within its range."""
    low_rad, high_rad = axis.reference_min_rad, axis.reference_max_rad
    if axis.reference_spans_zero:
        return words.held(reference_rad, low_rad, high_rad)
    return words.clamp(words.held(reference_rad, law.angle_min_rad, law.angle_max_rad), low_rad, high_rad)


def prefilter(
    law: FixedLaw[Any], axis: FixedAxis[Any], words: Words[Any], state: AxisState[Any], reference_rad: Any
) -> tuple[Any, Any]:
    """1/(T s + 1)^2 as two one-poles; they stay within the reference's range and arrive exactly at a reference at rest."""
    target_rad = held_reference(law, axis, words, reference_rad)
    target_rad = words.word("target_rad", target_rad * 2**axis.reference_doublings)
    if axis.prefilter_gain is None:
        return target_rad, target_rad
    first_rad = words.wrapped(state.reference_1_rad, FILTERED_BITS)
    first_rad = words.towards(first_rad, target_rad, axis.prefilter_gain)
    second_rad = words.wrapped(state.reference_2_rad, FILTERED_BITS)
    return first_rad, words.towards(second_rad, first_rad, axis.prefilter_gain)


def step_axis(
    law: FixedLaw[Any],
    axis: FixedAxis[Any],
    words: Words[Any],
    state: AxisState[Any],
    filtered_rad: tuple[Any, Any],
    angle_rad: Any,
    psi: tuple[Any, ...],
    u_ff_V: Any,
) -> tuple[AxisState[Any], Any]:
    """One axis from its angle to its limited voltage; returns what it remembers, and the voltage."""
    kept = within_ranges(law, axis, words, state)
    e_rad = differences(axis, words, kept, filtered_rad[1], angle_rad)
    total = move(axis, words, kept, e_rad, psi)
    after, u_V = drive(law, axis, words, kept, e_rad, words.whole(total, axis.residue_places), u_ff_V)
    v_residue = words.fraction(total, axis.residue_places)
    return replace(after, reference_1_rad=filtered_rad[0], reference_2_rad=filtered_rad[1], v_residue=v_residue), u_V


def within_ranges(law: FixedLaw[Any], axis: FixedAxis[Any], words: Words[Any], state: AxisState[Any]) -> AxisState[Any]:
    """The state with every word of the feedback in its range: unchanged unless it was broken."""
    bits = {
        **{f"e_{i}_rad": law.error_bits + i for i in range(3)},
        **{f"s_{i}_V": law.s_bits + i for i in range(4)},
        **{f"w_{i}_V": law.w_bits + i for i in range(3)},
    }
    wrapped = {name: words.wrapped(getattr(state, name), count) for name, count in bits.items()}
    return replace(state, v_residue=words.fraction(state.v_residue, axis.residue_places), **wrapped)


def differences(
    axis: FixedAxis[Any], words: Words[Any], state: AxisState[Any], reference_rad: Any, angle_rad: Any
) -> tuple[Any, Any, Any, Any]:
    """Error e and delta e, delta^2 e, delta^3 e."""
    half = 2 ** (axis.reference_doublings - 1)
    filtered_rad = words.floored(words.word("filtered_rad", reference_rad + half), axis.reference_doublings)
    e_0_rad = words.word("e_0_rad", filtered_rad - angle_rad)
    e_1_rad = words.word("e_1_rad", e_0_rad - state.e_0_rad)
    e_2_rad = words.word("e_2_rad", e_1_rad - state.e_1_rad)
    return e_0_rad, e_1_rad, e_2_rad, words.word("e_3_rad", e_2_rad - state.e_2_rad)


def move(
    axis: FixedAxis[Any], words: Words[Any], state: AxisState[Any], e_rad: tuple[Any, ...], psi: tuple[Any, ...]
) -> Any:
    """Change of v with the places of the sum, and what the last sample left: the products in the order of the equation."""
    errors = {f"e_{i}_rad": e for i, e in enumerate(e_rad)}
    total = state.v_residue
    for term in axis.terms:
        coefficient = polynomial(term.polynomial, words, psi, f"{axis.name}.{term.coefficient}")
        factor = errors[term.factor] if term.factor in errors else getattr(state, term.factor)
        if term.is_short:
            product = words.short_product(coefficient, factor) * 2**term.doublings
        else:
            product = words.narrow_product(coefficient, factor) if term.is_narrow else coefficient * factor
            product = words.floored(product, term.excess)
        total = total + product if term.sign > 0 else total - product
    return total


def drive(
    law: FixedLaw[Any],
    axis: FixedAxis[Any],
    words: Words[Any],
    state: AxisState[Any],
    e_rad: tuple[Any, ...],
    move_V: tuple[Any, Any],
    u_ff_V: Any,
) -> tuple[AxisState[Any], Any]:
    """From the move of v to the limited voltage; returns what the axis remembers, and the voltage.

    A move that takes v out of its range comes from a jump that no axis makes: v stays, and its differences are forgotten. To hold
    v at the end of the range instead would make a nonlinear filter of A, which need not come to rest.
    """
    last_V = words.wrapped(words.word("last v_V", state.s_0_V + state.w_0_V), law.w_bits - 1)
    fits, move_V_kept = move_V
    moved_V = words.word("v_V", last_V + move_V_kept)
    plausible = words.both(fits, words.is_within(moved_V, law.w_bits - 1))
    v_V = words.choose(plausible, moved_V, last_V)
    u_V = words.word("u_V", v_V + u_ff_V)
    limited_V = words.clamp(u_V, axis.u_min_V, axis.u_max_V)
    w_0_V = words.word("w_0_V", u_V - limited_V)
    w_1_V = words.choose(plausible, words.word("w_1_V", w_0_V - state.w_0_V), law.zero)
    w_2_V = words.choose(plausible, words.word("w_2_V", w_1_V - state.w_1_V), law.zero)
    s_0_V = words.word("s_0_V", limited_V - u_ff_V)  # = v - w
    s_1_V = words.choose(plausible, words.word("s_1_V", s_0_V - state.s_0_V), law.zero)
    s_2_V = words.choose(plausible, words.word("s_2_V", s_1_V - state.s_1_V), law.zero)
    s_3_V = words.choose(plausible, words.word("s_3_V", s_2_V - state.s_2_V), law.zero)
    after = replace(
        state,
        e_0_rad=e_rad[0],
        e_1_rad=e_rad[1],
        e_2_rad=e_rad[2],
        s_0_V=s_0_V,
        s_1_V=s_1_V,
        s_2_V=s_2_V,
        s_3_V=s_3_V,
        w_0_V=w_0_V,
        w_1_V=w_1_V,
        w_2_V=w_2_V,
    )
    return after, limited_V


def _axis_at_rest(
    law: FixedLaw[Any], axis: FixedAxis[Any], words: Words[Any], angle_rad: Any
) -> tuple[AxisState[Any], Any]:
    reference_rad = words.clamp(angle_rad, axis.reference_min_rad, axis.reference_max_rad)
    filtered_rad = words.word("reference at rest", reference_rad * 2**axis.reference_doublings)
    e_0_rad = words.word("error at rest", reference_rad - angle_rad)
    zeros = (law.zero,) * 7
    return AxisState(filtered_rad, filtered_rad, e_0_rad, law.zero, law.zero, axis.half_residue, *zeros), reference_rad
