"""Inputs and states on which executions of the fixed-point law are compared: those of the float32 law as words, and any words at all."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.arithmetic import Scalars
from codegen.fixed.constants import FixedAxis, FixedLaw, FixedTerm, fixed_constants, word_number
from codegen.fixed.equations import fixed_axis_state, law_reset, polynomial, schedule
from codegen.fixed.formats import FILTERED_BITS, MISSING, law_formats
from codegen.law_equations import state_words
from codegen.law_frame import words_from_state
from records.table import ControllerTable
from verification import stimuli
from verification.stimuli import Stimulus

Bits = NDArray[np.uint32]

EDGES = "edges of words"
_STARTS = 1024  # values of w, over all its range, of which the one is taken that leaves least to its difference
_NEIGHBOURS = 4

# Missing, the outermost, and the least words, a few powers of two and their neighbours.
SPECIAL_WORDS = np.array(
    [
        MISSING,
        MISSING + 1,
        2**31 - 1,
        0,
        1,
        -1,
        0x55555555,
        -(2**30),
        2**30,
        2**28 - 1,
        -(2**27),
        2**27,
        2**16,
        -(2**16),
    ],
    dtype=np.int32,
).view(np.uint32)


def fixed_stimuli(table: ControllerTable, steps: int = 100_000, seed: int = 1) -> tuple[Stimulus, ...]:
    """At least `steps` control steps: reference jumps, saturation, missing and special words, broken, edge and random states."""
    rng = np.random.default_rng(seed)
    share = -(-steps // 5)
    lanes = -(-share // 250)
    edges = at_the_edges(table)
    return (
        as_words(table, stimuli.reference_jumps(table, rng, 250, lanes)),
        as_words(table, stimuli.saturating(table, rng, 250, lanes)),
        with_special_words(table, rng, 250, lanes),
        from_random_states(table, rng, 2 * lanes, 125),
        from_random_words(table, rng, max(1, share - edges.steps)),
        edges,
    )


def fixed_sequences(table: ControllerTable, steps: int = 100_000, seed: int = 1) -> tuple[Stimulus, ...]:
    """The same kinds without set states, for a board that can only be reset and stepped."""
    rng = np.random.default_rng(seed)
    lanes = -(-steps // (3 * 250))
    return (
        as_words(table, stimuli.reference_jumps(table, rng, 250, lanes)),
        as_words(table, stimuli.saturating(table, rng, 250, lanes)),
        with_special_words(table, rng, 250, lanes),
    )


def as_words(table: ControllerTable, stimulus: Stimulus) -> Stimulus:
    """A stimulus of float32 angles and references, without set states, in the words of the fixed-point law."""
    places = law_formats(table).angle_places
    return Stimulus(stimulus.name, _words(stimulus.angles, places), _words(stimulus.inputs, places))


def with_special_words(table: ControllerTable, rng: np.random.Generator, steps: int, lanes: int) -> Stimulus:
    """Reference jumps in which one word in thirty is missing, outermost, least, or any."""
    plain = as_words(table, stimuli.reference_jumps(table, rng, steps, lanes))
    inputs = _sprinkled(plain.inputs, rng, 30)
    return Stimulus("special words", inputs[0, :, len(table.loops) :].copy(), inputs)


def from_random_states(table: ControllerTable, rng: np.random.Generator, lanes: int, steps: int) -> Stimulus:
    """States of all sizes, one word in fifty special, then ordinary inputs: broken states must heal alike."""
    plain = as_words(table, stimuli.reference_jumps(table, rng, steps, lanes))
    states = _sprinkled(_any_size(rng, (lanes, state_words(table))), rng, 50)
    return Stimulus("random states", plain.angles, plain.inputs, states)


def at_the_edges(table: ControllerTable) -> Stimulus:
    """One step from states that chance does not meet: a filter whose step is a whole word, feedback at either end of its range, a
    residue of ones alone. All else rests at the reference next to zero."""
    law, names = fixed_constants(table, word_number), [loop.axis for loop in table.loops]
    references = [min(max(0, axis.reference_min_rad), axis.reference_max_rad) for axis in law.axes]
    psi = schedule(law, Scalars(), references)
    states: list[dict[str, int]] = []
    for axis, reference in zip(law.axes, references, strict=True):
        target = reference * 2**axis.reference_doublings
        states += [
            {f"{axis.name}.reference_{index}_rad": target + sign * 2**places}
            for index in (1, 2)
            for places in range(FILTERED_BITS - 8, FILTERED_BITS + 1)
            for sign in (1, -1)
        ]
        states += _feedback_at_its_ends(law, axis, psi)
        states.append({f"{axis.name}.v_residue": -1})
    fields = fixed_axis_state(table.order).__dataclass_fields__
    place_of = {name: place for place, name in enumerate(f"{axis}.{field}" for axis in names for field in fields)}
    at_rest = [*words_from_state(law_reset(law, Scalars(), references))]
    words = np.tile(np.array(at_rest, dtype=np.int64), (len(states), 1))
    for row, state in zip(words, states, strict=True):
        for name, value in state.items():
            row[place_of[name]] = value
    given = np.tile(np.array([*references, *references], dtype=np.int32), (1, len(states), 1)).view(np.uint32)
    return Stimulus(EDGES, given[0, :, len(names) :].copy(), given, words.astype(np.int32).view(np.uint32))


def _feedback_at_its_ends(law: FixedLaw[int], axis: FixedAxis[int], psi: tuple[int, ...]) -> Iterator[dict[str, int]]:
    """States from which v moves to either end of its range and its neighbours, at rest but for w and one word that leads it there.

    That word is the difference of w, or, where none is fed back, the last one of the error. w, whose own share of the move is less
    than a word for each of its words, does the rest.
    """
    gains = {term.factor: _words_of_move(term, axis, psi) for term in axis.terms}
    of_w, error = gains.get("w_0_V", 0.0), law.order - 1
    if gains.get("w_1_V"):
        lead, gain, bits = "w_1_V", gains["w_1_V"], law.w_bits + 1
    else:
        lead, gain, bits = f"e_{error}_rad", -gains.get(f"e_{law.order}_rad", 0.0), law.error_bits + error
    if gain == 0.0 or of_w == -1.0:
        return
    w_0 = np.arange(0.5 - _STARTS / 2, _STARTS / 2) * (2.0 ** (law.w_bits + 1) / _STARTS)
    end = 2.0 ** (law.w_bits - 1)
    last = (w_0 + end) % (2 * end) - end
    for missing in (sign * end - last - of_w * w_0 for sign in (-1, 1)):
        nearest = np.argmin(abs(missing))
        led = round(missing[nearest] / gain)
        if abs(led) < 2**bits:
            for off in range(-_NEIGHBOURS, _NEIGHBOURS + 1):
                rest = (missing[nearest] - gain * led + off) / (1.0 + of_w)
                yield {f"{axis.name}.w_0_V": round(w_0[nearest] + rest), f"{axis.name}.{lead}": led}


def _words_of_move(term: FixedTerm[int], axis: FixedAxis[int], psi: tuple[int, ...]) -> float:
    """By how many words v moves for one of the term's factor."""
    coefficient: int = polynomial(term.polynomial, Scalars(), psi, term.coefficient)
    return float(term.sign * coefficient / 2.0 ** (term.excess - term.doublings + axis.residue_places))


def from_random_words(table: ControllerTable, rng: np.random.Generator, lanes: int) -> Stimulus:
    """One step from states and inputs of any 32 bits, in half of the lanes of all sizes."""
    size, loops = state_words(table), len(table.loops)
    words = rng.integers(0, 2**32, (lanes, size + 2 * loops), dtype=np.uint32)
    words[::2] = _sprinkled(_any_size(rng, words[::2].shape), rng, 16)
    inputs = words[np.newaxis, :, size:].copy()
    return Stimulus("random words", inputs[0, :, loops:].copy(), inputs, words[:, :size].copy())


def words_from_floats(values: NDArray[np.float64], places: int) -> Bits:
    """The nearest words; MISSING for what is not finite."""
    steps = np.round(np.where(np.isfinite(values), values, 0.0) * 2.0**places)
    held = np.clip(steps, MISSING + 1, -MISSING - 1).astype(np.int64)
    return np.where(np.isfinite(values), held, MISSING).astype(np.int32).view(np.uint32)


def _words(bits: Bits, places: int) -> Bits:
    with np.errstate(invalid="ignore"):
        return words_from_floats(bits.view(np.float32).astype(np.float64), places)


def _any_size(rng: np.random.Generator, shape: Sequence[int]) -> Bits:
    words = rng.integers(-(2**31), 2**31, tuple(shape), dtype=np.int32)
    return (words >> rng.integers(0, 32, words.shape, dtype=np.int32)).view(np.uint32)


def _sprinkled(words: Bits, rng: np.random.Generator, one_in: int) -> Bits:
    special = rng.choice(SPECIAL_WORDS, words.shape)
    return np.where(rng.integers(0, one_in, words.shape) == 0, special, words)
