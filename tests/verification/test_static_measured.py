"""Static bounds against the emulated board: never below what any input costs, and close to the dearest input found."""

import numpy as np
import pytest
from numpy.typing import NDArray

from codegen.law import generate_law
from codegen.law_equations import STATE_WORDS
from rig.emulator.board import EmulatedBoard
from rig.image import build_firmware
from rig.target_law import TargetLaw
from tests.law_tables import ce150_table
from tests.verification.static_programs import program
from verification.static_bound import static_bound
from verification.stimuli import SPECIAL_BITS, standard_stimuli

Words = NDArray[np.uint32]
SEED = 20


def nasty_floats(rng: np.random.Generator, shape: tuple[int, int]) -> Words:
    """Subnormals, tiny and ordinary normals, special numbers, any bits; both signs."""
    bits = rng.integers(0, 2**32, shape, dtype=np.uint32)
    subnormal = bits >> rng.integers(9, 32, shape).astype(np.uint32)
    tiny = (10.0 ** rng.uniform(-44.0, 0.0, shape)).astype(np.float32).view(np.uint32)
    ordinary = np.abs(rng.normal(0.0, 1.0, shape)).astype(np.float32).view(np.uint32)
    kinds = [subnormal, tiny, ordinary, rng.choice(SPECIAL_BITS, shape), bits]
    magnitude = np.choose(rng.choice(5, shape, p=(0.45, 0.3, 0.15, 0.05, 0.05)), kinds) & 0x7FFFFFFF
    return magnitude | rng.integers(0, 2, shape, dtype=np.uint32) << 31


def nearly_cancelling(rng: np.random.Generator, pairs: Words) -> Words:
    """Second arguments close to the first in magnitude: sums that lose many bits, comparisons decided late."""
    pairs = pairs.copy()
    near = rng.integers(0, 3, len(pairs)) == 0
    change = rng.integers(0, 64, near.sum(), dtype=np.uint32) | rng.integers(0, 2, near.sum(), dtype=np.uint32) << 31
    pairs[near, 1] = pairs[near, 0] ^ change
    return pairs


# How far the bound may lie above the dearest of 4 000 inputs: paths that exclude each other beyond what sets of words can show.
LAW_CLOSENESS = 1.6
CLOSENESS = {"sum": 1.2, "product": 1.2, "ratio": 1.2, "less": 1.1, "whole": 1.1, "as_float": 1.1}


@pytest.mark.parametrize("function", CLOSENESS)
def test_soft_float_never_costs_more_than_its_bound(function: str) -> None:
    elf = program().read_bytes()
    board, bound = EmulatedBoard(elf), static_bound(elf, function)
    rng = np.random.default_rng(SEED)
    calls = [board.call(function, int(a), int(b)) for a, b in nearly_cancelling(rng, nasty_floats(rng, (4000, 2)))]
    dearest = max(calls, key=lambda call: call.cycles)
    assert dearest.cycles <= bound.cycles_bound <= CLOSENESS[function] * dearest.cycles
    assert max(call.stack_bytes for call in calls) == bound.stack_bytes
    assert max(call.cycles_flash for call in calls) <= bound.cycles_bound_wait_states


def test_the_passes_of_a_division_follow_from_its_code() -> None:
    elf = program().read_bytes()
    board, bound = EmulatedBoard(elf), static_bound(elf, "quotient")
    rng = np.random.default_rng(SEED)
    pairs = rng.integers(0, 2**32, (2000, 2), dtype=np.uint32) >> rng.integers(0, 32, (2000, 2)).astype(np.uint32)
    dearest = max(board.call("quotient", int(a), int(b)).cycles for a, b in pairs)
    assert dearest <= bound.cycles_bound <= 1.2 * dearest


def subnormals(rng: np.random.Generator, shape: tuple[int, int]) -> Words:
    """Subnormals alone: the slow paths of products and sums, in every one of them."""
    bits = rng.integers(1, 0x800000, shape, dtype=np.uint32) >> rng.integers(0, 8, shape).astype(np.uint32)
    return bits | rng.integers(0, 2, shape, dtype=np.uint32) << 31


def test_one_step_of_the_law_never_costs_more_than_its_bound() -> None:
    table = ce150_table()
    elf = build_firmware(generate_law(table)).elf
    bound, law = static_bound(elf, "law_step"), TargetLaw(EmulatedBoard(elf))
    for stimulus in standard_stimuli(table, 20_000):
        states = law.start(stimulus.angles) if stimulus.states is None else stimulus.states
        law.run(states, stimulus.inputs)
    ordinary, rng = law.cycles_max, np.random.default_rng(SEED)
    for words in (nasty_floats(rng, (10_000, STATE_WORDS + 4)), subnormals(rng, (10_000, STATE_WORDS + 4))):
        law.run(words[:, :STATE_WORDS], words[np.newaxis, :, STATE_WORDS:])
    assert law.cycles_max > ordinary  # the stimuli of the equality tests do not look for the dearest step
    assert law.cycles_max <= bound.cycles_bound <= LAW_CLOSENESS * law.cycles_max
    assert law.stack_bytes == bound.stack_bytes
    assert sum(share.cycles for share in bound.path) == bound.cycles_bound
