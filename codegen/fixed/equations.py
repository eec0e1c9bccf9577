"""The fixed-point law, written once over words: integers, lanes of integers, intervals, or numbers that carry their error.

Functions, names and order of operations are those of templates/law_fixed.c.j2, and the equations those of law_equations.py:

    v = v(k-1) + Q e + z^-1 [-p_0 s + p_1 delta s + p_2 delta^2 s + ..] + z^-1 [-a_0 w + a_1 delta w + a_2 delta^2 w + ..]

with v(k-1) = s + w. All differences are exact; the products are summed exactly, and what the sum has below the last place of v
is carried to the next sample, so that rounding never adds up. A broken state is taken modulo the range of each word: the law goes
on from a bounded one, and forgets it as it forgets any disturbance.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from codegen.fixed.arithmetic import Words
from codegen.fixed.constants import FixedAxis, FixedLaw, FixedPolynomial
from codegen.fixed.formats import FILTERED_BITS
from codegen.law_equations import axis_state
from codegen.law_frame import LawInput, LawState, state_of_words


def fixed_axis_state(order: int) -> Any:
    """What one axis remembers, as law_equations.axis_state; in place of v = s + w stands what its sum has below the last place."""
    return axis_state(order, "v_residue")


def state_from_words(law: FixedLaw[Any], words: Any) -> LawState[Any]:
    """A state from its words in the order of the C structure; `words[i]` is word i."""
    return state_of_words(words, fixed_axis_state(law.order), len(law.axes))


def law_reset(law: FixedLaw[Any], words: Words[Any], angles_rad: Sequence[Any]) -> LawState[Any]:
    """The state at rest at these angles: the reference filters start there, the feedback at zero."""
    held_rad = tuple(held_angle(law, words, angle_rad, law.zero) for angle_rad in angles_rad)
    at_rest = [_axis_at_rest(law, axis, words, angle_rad) for axis, angle_rad in zip(law.axes, held_rad, strict=True)]
    axes, references_rad = zip(*at_rest, strict=True)
    return LawState(axes, held_rad, references_rad)


def law_step(
    law: FixedLaw[Any], words: Words[Any], state: LawState[Any], given: LawInput[Any]
) -> tuple[LawState[Any], tuple[Any, ...]]:
    """One sample of all axes: the new state and the limited voltages."""
    angles_rad = tuple(
        held_angle(law, words, angle_rad, last_rad)
        for angle_rad, last_rad in zip(given.angles_rad, state.angles_rad, strict=True)
    )
    references_rad = tuple(map(words.accepted, given.references_rad, state.references_rad))
    psi = schedule(law, words, angles_rad)

    filtered = [
        prefilter(law, axis, words, remembered, reference_rad)
        for axis, remembered, reference_rad in zip(law.axes, state.axes, references_rad, strict=True)
    ]
    psi_ref = region(law, words, [second_rad for _, second_rad in filtered])
    feedforwards_V = [feedforward(axis, words, psi_ref) for axis in law.axes]

    stepped = [
        step_axis(law, axis, words, remembered, filtered_rad, angle_rad, psi, u_ff_V)
        for axis, remembered, filtered_rad, angle_rad, u_ff_V in zip(
            law.axes, state.axes, filtered, angles_rad, feedforwards_V, strict=True
        )
    ]
    axes, voltages_V = zip(*stepped, strict=True)
    return LawState(axes, angles_rad, references_rad), voltages_V


def held_angle(law: FixedLaw[Any], words: Words[Any], angle_rad: Any, last_rad: Any) -> Any:
    """The angle, or the last one where it is missing, held within the limit that the formats are made for."""
    return words.held(words.accepted(angle_rad, last_rad), law.angle_min_rad, law.angle_max_rad)


def schedule(law: FixedLaw[Any], words: Words[Any], angles_rad: Sequence[Any]) -> tuple[Any, ...]:
    """Powers of the scheduling angle within the schedule's range."""
    if law.schedule is None:
        return powers_of(law, words, law.zero)
    psi_rad = words.clamp(angles_rad[law.schedule.index], law.schedule.min_rad, law.schedule.max_rad)
    return powers_of(law, words, psi_rad * 2**law.schedule_doublings)


def region(law: FixedLaw[Any], words: Words[Any], filtered_rad: Sequence[Any]) -> tuple[Any, ...]:
    """Powers of the filtered reference of the scheduling angle."""
    if law.schedule is None:
        return powers_of(law, words, law.zero)
    return powers_of(law, words, filtered_rad[law.schedule.index] * 2**law.reference_doublings)


def feedforward(axis: FixedAxis[Any], words: Words[Any], psi_ref: tuple[Any, ...]) -> Any:
    """The feed-forward voltage of one axis."""
    return polynomial(axis.feedforward_V, words, psi_ref, f"{axis.name}.u_ff_V")


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
    law: FixedLaw[Any], axis: FixedAxis[Any], words: Words[Any], state: Any, reference_rad: Any
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
    state: Any,
    filtered_rad: tuple[Any, Any],
    angle_rad: Any,
    psi: tuple[Any, ...],
    u_ff_V: Any,
) -> tuple[Any, Any]:
    """One axis from its angle to its limited voltage; returns what it remembers, and the voltage."""
    kept = within_ranges(law, axis, words, state)
    e_rad = differences(axis, words, kept, filtered_rad[1], angle_rad)
    total = move(axis, words, kept, e_rad, psi)
    after, u_V = drive(law, axis, words, kept, e_rad, words.whole(total, axis.residue_places), u_ff_V)
    v_residue = words.fraction(total, axis.residue_places)
    return replace(after, reference_1_rad=filtered_rad[0], reference_2_rad=filtered_rad[1], v_residue=v_residue), u_V


def within_ranges(law: FixedLaw[Any], axis: FixedAxis[Any], words: Words[Any], state: Any) -> Any:
    """The state with every word of the feedback in its range: unchanged unless it was broken."""
    bits = {
        name: first + power
        for names, first in ((state.E, law.error_bits), (state.S, law.s_bits), (state.W, law.w_bits))
        for power, name in enumerate(names)
    }
    wrapped = {name: words.wrapped(getattr(state, name), count) for name, count in bits.items()}
    return replace(state, v_residue=words.fraction(state.v_residue, axis.residue_places), **wrapped)


def differences(
    axis: FixedAxis[Any], words: Words[Any], state: Any, reference_rad: Any, angle_rad: Any
) -> tuple[Any, Any, Any, Any]:
    """Error e and delta e, delta^2 e and so on, one more than are remembered."""
    half = 2 ** (axis.reference_doublings - 1)
    filtered_rad = words.floored(words.word("filtered_rad", reference_rad + half), axis.reference_doublings)
    e_rad = [words.word("e_0_rad", filtered_rad - angle_rad)]
    for power, name in enumerate(state.E, start=1):
        e_rad.append(words.word(f"e_{power}_rad", e_rad[-1] - getattr(state, name)))
    return tuple(e_rad)


def move(axis: FixedAxis[Any], words: Words[Any], state: Any, e_rad: tuple[Any, ...], psi: tuple[Any, ...]) -> Any:
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
    state: Any,
    e_rad: tuple[Any, ...],
    move_V: tuple[Any, Any],
    u_ff_V: Any,
) -> tuple[Any, Any]:
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

    def moved_on(value: Any, names: tuple[str, ...]) -> dict[str, Any]:
        found = [words.word(names[0], value)]
        for name, last in zip(names[1:], names, strict=False):
            moved = words.word(name, found[-1] - getattr(state, last))
            found.append(words.choose(plausible, moved, law.zero))
        return dict(zip(names, found, strict=True))

    of_w, of_s = moved_on(u_V - limited_V, state.W), moved_on(limited_V - u_ff_V, state.S)  # s = v - w
    return replace(state, **dict(zip(state.E, e_rad, strict=False)), **of_w, **of_s), limited_V


def _axis_at_rest(law: FixedLaw[Any], axis: FixedAxis[Any], words: Words[Any], angle_rad: Any) -> tuple[Any, Any]:
    reference_rad = words.clamp(angle_rad, axis.reference_min_rad, axis.reference_max_rad)
    filtered_rad = words.word("reference at rest", reference_rad * 2**axis.reference_doublings)
    e_0_rad = words.word("error at rest", reference_rad - angle_rad)
    record = fixed_axis_state(law.order)
    at_zero = record(*(law.zero for _ in record.__dataclass_fields__))
    return replace(
        at_zero,
        reference_1_rad=filtered_rad,
        reference_2_rad=filtered_rad,
        e_0_rad=e_0_rad,
        v_residue=axis.half_residue,
    ), reference_rad
