"""Results of float routines, told apart by their sign: what a caller may go on with, and what that cost."""

import numpy as np
import pytest

from codegen.law import generate_law
from rig.emulator.board import EmulatedBoard
from tests.law_tables import ce150_table
from tests.verification.static_bound.test_measured import alone
from verification.static_bound import words
from verification.static_bound.bound import Analysis
from verification.static_bound.elf_image import load_elf
from verification.static_bound.routines import finite_parts
from verification.static_bound.words import TOP, Word

ARCS = (
    (0x3F000000, 0x3F800000),
    (0xBF000000, 0xBF800000),
    (0x3F7FFF00, 0x3F800100),
    (0x00000000, 0x00FFFFFF),
    (0x80000001, 0x80FFFFFF),
)
CALLS = 200


def holds(word: Word, value: int) -> bool:
    return words.within(word, value, value) is not None


def test_a_float_is_in_one_part_of_the_finite_ones_or_outside() -> None:
    for bits, part in ((0, 0), (1, 1), (0x7F7FFFFF, 1), (0x80000000, 2), (0xFF7FFFFF, 3)):
        assert [p is not None for p in finite_parts(words.constant(bits))] == [k == part for k in range(4)]
    for bits in (0x7F800000, 0x7FC00000, 0xFF800000, 0xFFFFFFFF):
        assert not any(finite_parts(words.constant(bits)))
    assert not any(finite_parts(TOP))


@pytest.mark.parametrize("routine", ["__aeabi_fadd", "__aeabi_fsub", "__aeabi_fmul"])
def test_every_result_is_in_a_part_that_costs_no_less(routine: str) -> None:
    elf = alone(generate_law(ce150_table(1)))
    board, analysis, rng = EmulatedBoard(elf), Analysis(load_elf(elf), ()), np.random.default_rng(3)
    function = analysis.image.function_named(routine)
    several = 0
    for a in ARCS:
        for b in ARCS:
            found = analysis.call(function, {0: words.interval(*a), 1: words.interval(*b)})
            several += len(found) > 1
            for x, y in zip(rng.integers(*a, CALLS), rng.integers(*b, CALLS), strict=True):
                call = board.call(routine, int(x), int(y))
                costs = [part.cycles.zero_wait for part in found if holds(part.results[0], call.result)]
                assert call.cycles <= max(costs, default=0), (routine, hex(x), hex(y))
    assert several > 0
