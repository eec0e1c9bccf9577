"""Bounds and rounding of laws that are no helicopter's: proved, and never below what is found."""

import numpy as np
import pytest

from codegen.law_constants import law_constants
from codegen.law_equations import law_step, state_from_words
from codegen.law_frame import LawInput, words_from_state
from codegen.twin import Float32Lanes
from records.table import ControllerTable
from tests.codegen.test_any_loops import any_table
from verification.fixed_rounding import fixed_rounding_bound
from verification.ranges import Motion, declared_ranges
from verification.rounding import rounding_bound

LANES = 5_000


@pytest.mark.parametrize(("orders", "scheduled"), [((1,), None), ((2,), 0), ((2, 1), 1)])
def test_no_sample_exceeds_the_bound(orders: tuple[int, ...], scheduled: int | None) -> None:
    """Truth: the same step in double precision, from states and inputs within the declared ranges; by name of each voltage."""
    table = any_table(orders, scheduled, roll_off=False)
    motion = Motion((1.0,) * len(orders), (2.0,) * len(orders))
    bound = rounding_bound(table, motion, slices=4)
    found = _apart(table, motion)
    assert list(bound.volts) == [loop.voltage for loop in table.loops]
    assert (found <= list(bound.volts.values())).all()
    assert (found > 0.0).all()


def test_a_law_in_words_of_one_loop_has_a_bound_as_well() -> None:
    bound = fixed_rounding_bound(any_table((2,), 0, roll_off=False), Motion((1.0,), (2.0,)), slices=4)
    assert 0.0 < bound.volts["u"] < 0.01
    assert "Arb" in bound.method


def _apart(table: ControllerTable, motion: Motion) -> np.ndarray:
    """The largest |float32 - float64| of each voltage over random states and inputs at rest in their errors' differences."""
    ranges, rng = declared_ranges(table, motion), np.random.default_rng(2)
    drawn = [rng.uniform(*limits, LANES).astype(np.float32) for limits in words_from_state(ranges.state)]
    given = [
        rng.uniform(*limits, LANES).astype(np.float32)
        for limits in (*ranges.given.references_rad, *ranges.given.angles_rad)
    ]
    voltages = []
    for number in (np.float32, np.float64):
        state = state_from_words(table, [word.astype(number) for word in drawn])
        _, answer = law_step(
            law_constants(table, number), Float32Lanes(), state, LawInput.of([word.astype(number) for word in given])
        )
        voltages.append(np.array(answer, dtype=np.float64))
    return np.abs(voltages[0] - voltages[1]).max(axis=1)
