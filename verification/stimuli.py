"""Inputs and states on which executions of the law are compared: seeded, and chosen to be nasty."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.law_equations import axis_state, state_words
from codegen.scales import widest_reference
from records.law_table import AxisRange, FlownTable
from records.table import PLAUSIBLE_V, ControllerTable

Bits = NDArray[np.uint32]
Numbers = NDArray[np.float32]

# Quiet and signalling NaN with payloads, infinities, zeros, least and largest subnormal, least normal, largest, ordinary.
SPECIAL_BITS = np.array(
    [
        *(0x7FC00000, 0xFFC12345, 0x7F800001, 0xFF812345, 0x7F800000, 0xFF800000, 0x00000000, 0x80000000),
        *(0x00000001, 0x80000001, 0x007FFFFF, 0x807FFFFF, 0x00800000, 0x7F7FFFFF, 0xFF7FFFFF),
        *(0x3F800000, 0x3DCCCCCD, 0xC1200000, 0x4B800000, 0x35800000),
    ],
    dtype=np.uint32,
)


BEYOND = 1.2  # times the largest reference: as far as stimuli go where that is far
JUMPS = "reference jumps"
ARRIVALS = "arrivals"  # the stimulus of filters that are all but there


@dataclass(frozen=True)
class Stimulus:
    """Lanes of the law to be stepped together, all numbers as bits.

    `angles` [lanes, loops] start the lanes at rest; `states` [lanes, words], where given, replace them.
    `inputs` [steps, lanes, 2 loops] hold the references, then the angles, of all loops.
    """

    name: str
    angles: Bits
    inputs: Bits
    states: Bits | None = None

    @property
    def steps(self) -> int:
        """Control steps in all lanes together."""
        return int(self.inputs.shape[0] * self.inputs.shape[1])


def standard_stimuli(
    table: FlownTable, steps: int = 100_000, seed: int = 1, words: int | None = None
) -> tuple[Stimulus, ...]:
    """At least `steps` control steps: reference jumps, saturation, missing and special numbers, broken and random states, arrivals.

    `words` are those of a state; None for a table of the scheduled law.
    """
    rng = np.random.default_rng(seed)
    share = -(-steps // 5)
    lanes = -(-share // 250)
    arrivals = max(2, -(-lanes // 20))  # from either side
    return (
        reference_jumps(table, rng, 250, lanes),
        saturating(table, rng, 250, lanes),
        with_special_numbers(table, rng, 250, lanes),
        from_random_states(table, rng, 2 * lanes, 125, words),
        from_random_bits(table, rng, max(1, share - 125 * arrivals), words),
        arriving(table, rng, 125, arrivals),
    )


def sequences(table: FlownTable, steps: int = 100_000, seed: int = 1) -> tuple[Stimulus, ...]:
    """The same kinds without set states, for a board that can only be reset and stepped."""
    rng = np.random.default_rng(seed)
    lanes = -(-steps // (3 * 250))
    return (
        reference_jumps(table, rng, 250, lanes),
        saturating(table, rng, 250, lanes),
        with_special_numbers(table, rng, 250, lanes),
    )


def reference_jumps(table: FlownTable, rng: np.random.Generator, steps: int, lanes: int) -> Stimulus:
    """Angles that wander by encoder steps, references that jump every now and then to anywhere within their range."""
    angles = np.stack([_wander(axis, rng, steps, lanes) for axis in table.axes], axis=-1)
    references = np.stack([_jumps(axis, rng, steps, lanes) for axis in table.axes], axis=-1)
    inputs = np.concatenate([references, angles], axis=-1).astype(np.float32)
    return _from_rest(JUMPS, _bits(inputs))


def saturating(table: FlownTable, rng: np.random.Generator, steps: int, lanes: int) -> Stimulus:
    """References beyond their range and angles that jump from stop to stop, so that both outputs dwell at their limits."""
    shape = (steps, lanes, 2 * len(table.loops))
    dwell = rng.integers(0, 20, shape) == 0
    reach = np.array([max(3.0, BEYOND * widest_reference(axis)) for axis in table.axes] * 2)
    inputs = _held_where_not(dwell, rng.uniform(-reach, reach, shape)).astype(np.float32)
    return _from_rest("saturation", _bits(inputs))


def with_special_numbers(table: FlownTable, rng: np.random.Generator, steps: int, lanes: int) -> Stimulus:
    """Reference jumps in which one number in thirty is NaN, infinite, subnormal, zero of either sign, huge or tiny."""
    plain = reference_jumps(table, rng, steps, lanes)
    special = rng.choice(SPECIAL_BITS, plain.inputs.shape)
    inputs = np.where(rng.integers(0, 30, plain.inputs.shape) == 0, special, plain.inputs)
    return _from_rest("special numbers", inputs)


def from_random_states(
    table: FlownTable, rng: np.random.Generator, lanes: int, steps: int, words: int | None = None
) -> Stimulus:
    """States of ordinary size, one number in fifty special, then ordinary inputs: broken states must heal alike."""
    plain = reference_jumps(table, rng, steps, lanes)
    ordinary = _bits(rng.normal(0.0, 3.0, (lanes, _words(table, words))).astype(np.float32))
    special = rng.choice(SPECIAL_BITS, ordinary.shape)
    states = np.where(rng.integers(0, 50, ordinary.shape) == 0, special, ordinary)
    return Stimulus("random states", plain.angles, plain.inputs, states)


def from_random_bits(table: FlownTable, rng: np.random.Generator, lanes: int, words: int | None = None) -> Stimulus:
    """One step from states and inputs of any bits: in half of the lanes all words, in the others one in eight.

    With all words random nearly every state is broken; with a few, each guard is met with the rest of the law in order.
    """
    wild = np.arange(lanes)[:, np.newaxis] % 2 == 0
    size = _words(table, words)
    bits = rng.normal(0.0, 1.0, (lanes, size + 2 * len(table.loops))).astype(np.float32).view(np.uint32)
    any_bits = rng.integers(0, 2**32, bits.shape, dtype=np.uint32)
    special = rng.choice(SPECIAL_BITS, bits.shape)
    draw = rng.integers(0, 16, bits.shape)
    bits = np.where(wild | (draw == 0), any_bits, np.where(draw == 1, special, bits))
    return _from_rest("random bits", bits[np.newaxis, :, size:].copy(), bits[:, :size].copy())


def arriving(table: FlownTable, rng: np.random.Generator, steps: int, lanes: int) -> Stimulus:
    """References up to 60 last places from where the filters rest, by turns above and below: too near for a rounded step."""
    starts = np.stack(
        [rng.uniform(axis.reference_min_rad, axis.reference_max_rad, lanes) for axis in table.axes],
        axis=-1,
    ).astype(np.float32)
    side = 1 - 2 * (np.add.outer(np.arange(lanes), np.arange(len(table.axes))) % 2)
    references = starts + (side * rng.integers(1, 61, starts.shape)).astype(np.float32) * np.abs(np.spacing(starts))
    inputs = np.repeat(np.concatenate([references, starts], axis=-1)[np.newaxis], steps, axis=0)
    return Stimulus(ARRIVALS, _bits(starts), _bits(inputs))


def at_the_bound(table: ControllerTable) -> Stimulus:
    """One step at rest from v at the bound of what is plausible, and from its neighbours beyond: chance meets neither."""
    bound = np.float32(PLAUSIBLE_V)
    v_V = [sign * size for sign in (1.0, -1.0) for size in (bound, np.nextafter(bound, np.float32(np.inf)))]
    angles = np.array([0.5 * (axis.reference_min_rad + axis.reference_max_rad) for axis in table.axes], np.float32)
    names = list(axis_state(table.order).__dataclass_fields__)
    remembered = np.zeros((len(v_V), len(angles), len(names)), np.float32)
    remembered[:, :, names.index("v_V")] = np.array(v_V, np.float32)[:, np.newaxis]
    for name in ("reference_1_rad", "reference_2_rad"):
        remembered[:, :, names.index(name)] = angles
    accepted = np.tile(np.concatenate([angles, angles]), (len(v_V), 1))
    states = np.concatenate([remembered.reshape(len(v_V), -1), accepted], axis=1)
    return _from_rest("bound", _bits(accepted[np.newaxis]), _bits(states))


def _from_rest(name: str, inputs: Bits, states: Bits | None = None) -> Stimulus:
    """Lanes that begin at rest at the angles of their first row, or in `states`."""
    return Stimulus(name, inputs[0, :, inputs.shape[-1] // 2 :].copy(), inputs, states)


def _words(table: FlownTable, words: int | None) -> int:
    if words is not None:
        return words
    assert isinstance(table, ControllerTable), "another controller's states have a size of their own"
    return state_words(table)


def _wander(axis: AxisRange, rng: np.random.Generator, steps: int, lanes: int) -> NDArray[np.float64]:
    moves_rad = rng.integers(-6, 7, (steps, lanes)) * axis.resolution_rad
    start_rad = rng.uniform(axis.reference_min_rad, axis.reference_max_rad, lanes)
    return start_rad + np.cumsum(moves_rad, axis=0)


def _jumps(axis: AxisRange, rng: np.random.Generator, steps: int, lanes: int) -> NDArray[np.float64]:
    levels_rad = rng.uniform(1.1 * axis.reference_min_rad, 1.1 * axis.reference_max_rad, (steps, lanes))
    return _held_where_not(rng.integers(0, 60, (steps, lanes)) == 0, levels_rad)


def _held_where_not(change: NDArray[np.bool_], levels: NDArray[np.float64]) -> NDArray[np.float64]:
    """`levels` where `change` holds (and in the first row), held from row to row elsewhere."""
    change[0] = True
    rows = np.where(change, np.arange(len(change)).reshape(-1, *[1] * (change.ndim - 1)), 0)
    return np.asarray(np.take_along_axis(levels, np.maximum.accumulate(rows, axis=0), axis=0))


def _bits(numbers: Numbers) -> Bits:
    return np.ascontiguousarray(numbers, dtype=np.float32).view(np.uint32)
