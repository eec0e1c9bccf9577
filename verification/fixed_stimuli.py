"""Inputs and states on which executions of the fixed-point law are compared: those of the float32 law as words, and any words at all."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.constants import FixedAxis, fixed_constants, word_number
from codegen.fixed.equations import fixed_axis_state
from codegen.fixed.formats import FILTERED_BITS, MISSING, law_formats
from codegen.law_equations import state_words
from records.table import ControllerTable
from verification import stimuli
from verification.stimuli import Stimulus

Bits = NDArray[np.uint32]

EDGES = "edges of words"
_MOVE_BITS = 20  # how far the last step of v at the end of its range goes
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
    """One step from states that chance does not meet: a filter whose step is a whole word, feedback at either end of its range."""
    law = fixed_constants(table, word_number)
    names = [loop.axis for loop in table.loops]
    states = [
        {f"{axis}.reference_{index}_rad": sign * 2**places for axis in names for index in (1, 2)}
        for places in range(FILTERED_BITS - 8, FILTERED_BITS + 1)
        for sign in (1, -1)
    ]
    states += [state for axis in law.axes for state in _feedback_at_its_ends(axis, law.w_bits - 1)]
    fields = fixed_axis_state(table.order).__dataclass_fields__
    place_of = {name: place for place, name in enumerate(f"{axis}.{field}" for axis in names for field in fields)}
    words = np.zeros((len(states), state_words(table)), dtype=np.int64)
    for row, state in zip(words, states, strict=True):
        for name, value in state.items():
            row[place_of[name]] = value
    at_rest = np.zeros((1, len(states), 2 * len(names)), dtype=np.uint32)
    return Stimulus(EDGES, at_rest[0, :, len(names) :].copy(), at_rest, words.astype(np.int32).view(np.uint32))


def _feedback_at_its_ends(axis: FixedAxis[int], bits: int) -> Iterator[dict[str, int]]:
    """States from which v moves to -2^bits or 2^bits and its neighbours: w far out, its difference takes it there."""
    gains = {
        term.factor: term.sign * term.polynomial.constant / 2.0 ** (term.excess - term.doublings + axis.residue_places)
        for term in axis.terms
    }
    if not gains.get("w_1_V"):  # of one state there is no difference of w to lead it there
        return
    for sign in (1, -1):
        w_0, move = sign * (2**bits - 2**_MOVE_BITS), sign * 2**_MOVE_BITS
        w_1 = round((move - gains.get("w_0_V", 0.0) * w_0) / gains["w_1_V"])
        for off in range(-_NEIGHBOURS, _NEIGHBOURS + 1):
            yield {f"{axis.name}.w_0_V": w_0, f"{axis.name}.w_1_V": w_1 + off}


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
