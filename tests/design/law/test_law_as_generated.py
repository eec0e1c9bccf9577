"""The design's law and the equations that become C, in double precision: the same answers in every corner, not only in flight.

Sums are taken in another order, so to 1e-9 of the largest; what is decided (limits, restarts, what is accepted) is equal.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from codegen import law_equations
from codegen.law_constants import law_constants
from codegen.law_frame import LawInput, words_from_state
from codegen.twin import Float32Scalars
from design.law import AxisState, LawState, law_reset, law_step
from design.settings import read_settings
from records.table import LEAST_SCHEDULE_RAD, PLAUSIBLE_V
from tests.design.helicopter import helicopter, table_for
from tests.soak import SOAK


class Doubles(Float32Scalars):
    """The generated law's decisions on doubles: only its zero and its least step are those of float32."""

    def finite_or(self, value, last):
        return float(super().finite_or(value, last))

    def advanced(self, last, step, target):
        return last + step


TABLE = table_for(read_settings(helicopter()))
CONSTANTS, DECISIONS = law_constants(TABLE, float), Doubles()
ORDINARY = st.floats(-3.0, 3.0)
BROKEN = st.sampled_from([math.nan, math.inf, -math.inf, 1e300, -1e300, 1e30, 5e-324, 0.0, LEAST_SCHEDULE_RAD / 2])
NUMBERS = st.one_of(ORDINARY, BROKEN)
RESETS = (0.0, 0.3, -math.pi / 4.0, 2.0, -3.0, math.nan, math.inf)


def words(state: LawState) -> list[float]:
    """A state in the order of the generated structure."""

    def axis(a: AxisState) -> list[float]:
        return [a.x1_rad, a.x2_rad, *a.e, a.v_V, *a.s, *a.w]

    accepted = [[a.angle_rad for a in (state[0], state[1])]]
    accepted += [[a.reference_rad for a in (state[0], state[1])]]
    return [*axis(state[0]), *axis(state[1]), *accepted[0], *accepted[1]]


def side_by_side(state: LawState, samples: list[tuple[float, ...]]) -> None:
    """Step both from `state` and demand the same voltages and the same memory after every sample."""
    other = law_equations.state_from_words(TABLE, words(state))
    for sample in samples:
        state, voltages_V = law_step(TABLE, state, *sample)
        with np.errstate(all="ignore"):
            other, wanted_V = law_equations.law_step(CONSTANTS, DECISIONS, other, LawInput.of(sample))
        assert voltages_V == pytest.approx(wanted_V, rel=1e-9, abs=1e-6)
        assert words(state) == pytest.approx(list(words_from_state(other)), rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("psi_rad", RESETS)
@pytest.mark.parametrize("phi_rad", RESETS)
def test_both_start_alike_also_outside_the_range_of_the_reference(psi_rad, phi_rad):
    state = law_reset(TABLE, psi_rad, phi_rad)
    assert words(state) == list(words_from_state(law_equations.law_reset(CONSTANTS, DECISIONS, (psi_rad, phi_rad))))
    side_by_side(state, [(0.1, -0.2, psi_rad, phi_rad), (math.nan, 9.0, 0.0, 0.0), (0.2, 0.2, 1e-12, -1e-12)])


@given(st.lists(NUMBERS, min_size=30, max_size=30), st.lists(st.tuples(*[NUMBERS] * 4), min_size=1, max_size=6))
@example([math.nan] * 30, [(0.1, 0.2, 0.0, 0.0)] * 2)
@example([0.1] * 5 + [2 * PLAUSIBLE_V] + [0.1] * 24, [(0.1, 0.2, 0.0, 0.0)] * 2)
@settings(max_examples=300 if SOAK else 80, deadline=None, derandomize=True)
def test_both_answer_any_state_and_any_input_alike(numbers, samples):
    side_by_side(from_words(numbers), samples)


def from_words(numbers: list[float]) -> LawState:
    """Any memory with s_0 = v - w_0: the generated law has no p_0 with integral action and would notice a broken s_0 one sample later."""

    def axis(first: int, place: int) -> AxisState:
        x1, x2, e_0, e_1, e_2, v, _, s_1, s_2, s_3, *w = numbers[first : first + 13]
        return AxisState(
            numbers[28 + place], numbers[26 + place], x1, x2, v, (e_0, e_1, e_2), (v - w[0], s_1, s_2, s_3), tuple(w)
        )

    return axis(0, 0), axis(13, 1)


def test_a_restart_keeps_the_present_error_so_that_the_next_sample_sees_no_jump():
    state = law_reset(TABLE, 0.0, 0.0)
    for _ in range(50):
        state, _ = law_step(TABLE, state, 0.2, 0.0, 0.0, 0.0)
    broken = (replace(state[0], v_V=math.nan), state[1])
    healed, _ = law_step(TABLE, broken, 0.2, 0.0, 0.0, 0.0)
    assert healed[0].e == (pytest.approx(healed[0].x2_rad), 0.0, 0.0)
    assert healed[0].v_V == 0.0


def test_a_broken_prefilter_heals_within_one_sample():
    state = law_reset(TABLE, 0.0, 0.0)
    broken = (replace(state[0], x1_rad=math.nan, x2_rad=math.inf), state[1])
    healed, _ = law_step(TABLE, broken, 0.1, 0.0, 0.0, 0.0)
    assert (healed[0].x1_rad, healed[0].x2_rad) == (0.1, 0.1)
