"""The proved bound on one step in fixed point holds on every step that is tried, is of use, and refuses what it cannot prove."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from codegen.fixed.constants import fixed_constants
from codegen.fixed.twin import FixedTwin
from codegen.twin import PWM_TICKS
from design.law import law_reset, law_step
from records.loops import FULL_SCALE_V
from records.verification import RoundingBound
from tests.law_tables import ce150_table, dense_table
from verification.fixed_rounding import fixed_rounding_bound
from verification.fixed_words import TrackedWords
from verification.ranges import CE150_MOTION

HALF_TICK_V = FULL_SCALE_V / PWM_TICKS / 2.0


@cache
def usual_bound() -> RoundingBound:
    return fixed_rounding_bound(ce150_table())


@pytest.mark.parametrize("bound_of", [usual_bound, lambda: fixed_rounding_bound(dense_table())], ids=["ce150", "dense"])
def test_the_bound_is_below_half_a_pwm_tick(bound_of: Callable[[], RoundingBound]) -> None:
    bound = bound_of()
    assert 0.0 < bound.volts["u_M"] < HALF_TICK_V
    assert 0.0 < bound.volts["u_T"] < HALF_TICK_V
    assert "Arb" in bound.method


def test_first_steps_of_the_law_differ_from_real_arithmetic_by_less_than_the_bound() -> None:
    """From rest anywhere to a reference and an angle nearby: both laws start from the same state and inputs."""
    table = ce150_table()
    bound, twin, rng = usual_bound(), FixedTwin(table), np.random.default_rng(5)
    worst = np.zeros(2)
    for _ in range(500):
        psi_rad, phi_rad = (round(angle * 2**25) / 2**25 for angle in rng.uniform(-0.78, 0.78, 2))
        angles = [round((angle + rng.uniform(-0.1, 0.1)) * 2**25) / 2**25 for angle in (psi_rad, phi_rad)]
        references = [round(angle * 2**25) / 2**25 for angle in rng.uniform(-0.69, 0.69, 2)]
        twin.reset(psi_rad, phi_rad)
        fixed = twin.step(*references, *angles)
        _, real = law_step(table, law_reset(table, psi_rad, phi_rad), *references, *angles)
        worst = np.maximum(worst, np.abs(np.subtract(fixed, real)))
    assert (worst <= list(bound.volts.values())).all()
    assert (worst > 0.01 * np.array(list(bound.volts.values()))).all()


def test_more_slices_tighten_the_bound_and_more_motion_widens_it() -> None:
    table = ce150_table()
    usual, coarse = usual_bound(), fixed_rounding_bound(table, slices=4)
    slow = fixed_rounding_bound(table, replace(CE150_MOTION, rates_rad_s=(5.0, 5.0)))
    assert slow.volts["u_M"] < usual.volts["u_M"] <= coarse.volts["u_M"]


def test_motion_that_could_make_the_law_give_up_its_feedback_is_refused() -> None:
    with pytest.raises(ValueError, match="ranges too wide: feedback of up to"):
        fixed_rounding_bound(ce150_table(), replace(CE150_MOTION, rates_rad_s=(500.0, 500.0)))


def test_a_tracked_word_encloses_what_flooring_takes_off() -> None:
    words = TrackedWords()
    law: Any = fixed_constants(ce150_table(), words.constant)
    exact = words.within(-1000.0, 1000.0)
    assert exact.error == 0.0
    assert 0.9 < words.floored(exact, 3).error <= 1.0 + 1e-9
    assert 0.49 < words.floored(exact + 4, 3).error <= 0.5 + 1e-9
    assert words.scaled(law.axes[0].terms[0].polynomial.constant, exact).error <= 3.01
