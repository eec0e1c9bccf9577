"""Static bounds against the emulated board: never below what any input costs, and close to the dearest input found."""

import json
from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

from codegen.law import generate_law
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import FIRMWARE_DIR, build_firmware
from tests.law_tables import ce150_table
from tests.plants import stated_table
from tests.rig.emulator.programs import FOLDER
from tests.soak import SOAK, sampled
from tests.verification.cycles import nasty_floats, stimuli
from tests.verification.dearest import FOUND, Step, dearest, known
from tests.verification.static_bound.static_programs import program
from toolchain.host import CText
from toolchain.target import build_image
from verification.static_bound import static_bound

Words = NDArray[np.uint32]
SEED = 20
CALLS = 4000 if SOAK else 1000


def nearly_cancelling(rng: np.random.Generator, pairs: Words) -> Words:
    """Second arguments close to the first in magnitude: sums that lose many bits, comparisons decided late."""
    pairs = pairs.copy()
    near = rng.integers(0, 3, len(pairs)) == 0
    change = rng.integers(0, 64, near.sum(), dtype=np.uint32) | rng.integers(0, 2, near.sum(), dtype=np.uint32) << 31
    pairs[near, 1] = pairs[near, 0] ^ change
    return pairs


# How far the bound may lie above the dearest of 1 000 inputs of each kind, by the degree of the polynomials: paths that exclude each other
# beyond what sets of words can show (1.18, 1.17).
LAW_CLOSENESS = {1: 1.2, 3: 1.2}
MOST_CYCLES = 10_500  # in float32, whatever the bits, of the polynomials of degree 3
CLOSENESS = {"sum": 1.2, "product": 1.2, "ratio": 1.2, "less": 1.1, "whole": 1.1, "as_float": 1.1}


@pytest.mark.parametrize("function", CLOSENESS)
def test_soft_float_never_costs_more_than_its_bound(function: str) -> None:
    elf = program().read_bytes()
    board, bound = EmulatedBoard(elf), static_bound(elf, function)
    rng = np.random.default_rng(SEED)
    calls = [board.call(function, int(a), int(b)) for a, b in nearly_cancelling(rng, nasty_floats(rng, (CALLS, 2)))]
    dearest = max(calls, key=lambda call: call.cycles)
    assert dearest.cycles <= bound.cycles_bound <= CLOSENESS[function] * dearest.cycles
    assert max(call.stack_bytes for call in calls) == bound.stack_bytes
    assert max(call.cycles_flash for call in calls) <= bound.cycles_bound_wait_states


@pytest.mark.parametrize("function", sampled(["byte_quotient", "quotient"], keep=["byte_quotient"]))
def test_the_passes_of_a_division_follow_from_its_code(function: str) -> None:
    """Of bytes it takes a third of a second, of words twenty."""
    elf = program().read_bytes()
    board, bound = EmulatedBoard(elf), static_bound(elf, function)
    rng = np.random.default_rng(SEED)
    pairs = rng.integers(0, 2**32, (CALLS, 2), dtype=np.uint32) >> rng.integers(0, 32, (CALLS, 2)).astype(np.uint32)
    dearest = max(board.call(function, int(a), int(b)).cycles for a, b in pairs)
    assert dearest <= bound.cycles_bound <= 1.2 * dearest


KEEPING = CText(
    "kept.c",
    """
    #include "law.h"
    extern uint32_t _stack_top;
    void Reset_Handler(void);
    static void (*const table[48])(void) __attribute__((section(".vectors"), used)) = {(void (*)(void))&_stack_top, Reset_Handler};
    static void *const law[2] __attribute__((used, retain)) = {(void *)law_step, (void *)law_reset};
    void Reset_Handler(void) { for (;;) {} }
    """,
)


def alone(law: Mapping[str, str]) -> bytes:
    """The law's object code as in the firmware, with the float routines of the board and nothing else."""
    texts = [CText(name, text) for name, text in law.items() if name in ("law.h", "law.c")]
    sources = [*texts, KEEPING, FIRMWARE_DIR / "board" / "float_routines.c"]
    return build_image("law-alone", sources, FOLDER / "board.ld", include_dirs=[FIRMWARE_DIR / "board"]).read_bytes()


def test_the_bound_lies_within_a_tenth_of_a_step_that_there_is() -> None:
    ((_, stated, _),) = json.loads(FOUND.read_text(encoding="utf-8"))
    elf = build_firmware(generate_law(stated_table("ce150"))).elf
    assert Step(elf).cycles(known()) == stated
    assert stated <= static_bound(elf, "law_step").cycles_bound <= 1.1 * stated


@pytest.mark.soak
def test_a_search_for_the_dearest_step_stays_below_the_bound() -> None:
    """Of 100 000 steps, each a change of one that was dear."""
    table = ce150_table()
    elf = build_firmware(generate_law(table)).elf
    assert dearest(stimuli(table, "float32", 4_000), elf, 100_000)[0] <= static_bound(elf, "law_step").cycles_bound


@pytest.mark.parametrize("degree", sampled(LAW_CLOSENESS, keep=[1]))
def test_one_step_of_the_law_never_costs_more_than_its_bound(degree: int) -> None:
    table = ce150_table(degree)
    elf = alone(generate_law(table))
    bound, law = static_bound(elf, "law_step"), TargetLaw(EmulatedBoard(elf))
    for stimulus in stimuli(table, "float32", 20_000 if SOAK else 1_000):
        states = law.start(stimulus.angles) if stimulus.states is None else stimulus.states
        law.run(states, stimulus.inputs)
    assert bound.cycles_bound < MOST_CYCLES
    assert law.cycles_max <= bound.cycles_bound <= LAW_CLOSENESS[degree] * law.cycles_max
    assert law.stack_bytes == bound.stack_bytes
    assert sum(share.cycles for share in bound.path) == bound.cycles_bound
