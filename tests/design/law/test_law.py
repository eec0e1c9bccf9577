"""The law in double precision: its equation, its limits, and what it does with inputs that are no numbers."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from design.direct_form import DeltaForm, to_direct
from design.law import FloatLaw, law_reset, law_step, polynomial, saturate
from design.schedule import evaluate, schedule_of
from design.settings import read_settings
from tests.design.helicopter import DOM2, equal, helicopter, settings_for, table_for
from tests.law_tables import ce150_table

TABLE = ce150_table()
ANGLES = st.floats(-0.78, 0.78)


def unfiltered(table):
    return replace(table, axes=tuple(replace(axis, prefilter_time_constant_s=0.0) for axis in table.axes))


@pytest.mark.parametrize(
    "wishes",
    [settings_for((DOM2, "integral")), settings_for((equal(-8.0), "q3_zero")), read_settings(helicopter())],
    ids=["six poles", "no integrator", "roll-off"],
)
def test_law_fulfils_A_v_equals_Q_e_plus_A_minus_P_s_also_when_saturated(wishes):
    """At a constant scheduling angle, in the paper's powers of z^-1 and with the table's own A: recursion over stored v, s, e."""
    table = unfiltered(table_for(wishes))
    psi, law = 0.25, table.axes[0]
    form = to_direct(evaluate(schedule_of(law), psi))
    observer = np.zeros(len(form.p))
    observer[:4] = to_direct(DeltaForm(form.q, np.array(law.a))).p
    order = len(form.p) - 1
    state, rng = law_reset(table, psi, 0.0), np.random.default_rng(5)
    v, s, e = np.zeros(5), np.zeros(5), np.zeros(4)
    feedforward_V, saturated = 0.0, 0
    for _ in range(400):
        reference = psi + rng.uniform(-0.9, 0.4)
        state, (u_M_V, _) = law_step(table, state, reference, 0.0, psi, 0.0)
        feedforward_V = polynomial(law.feedforward_V, reference)
        e = np.append(reference - psi, e[:3])
        now = form.q @ e + (observer - form.p)[1:] @ s[:order] - observer[1:] @ v[:order]
        v, s = np.append(now, v[:4]), np.append(u_M_V - feedforward_V, s[:4])
        saturated += u_M_V in (law.u_min_V, law.u_max_V)
        assert u_M_V == pytest.approx(np.clip(now + feedforward_V, law.u_min_V, law.u_max_V), abs=1e-7)
    assert saturated > 20


def test_integral_action_holds_its_voltage_where_the_error_is_zero():
    # Truth: a held voltage does not drift; rounding's last bits may ring. A P(1) of 1e-12 would move it by 2e-8 V in these 200 s.
    table = unfiltered(table_for(settings_for()))
    state = law_reset(table, 0.0, 0.0)
    for _ in range(5):
        state, _ = law_step(table, state, 0.01, 0.02, 0.0, 0.0)
    held = []
    for _ in range(22000):
        state, u_V = law_step(table, state, 0.0, 0.0, 0.0, 0.0)
        held.append(u_V)
    assert np.all(np.ptp(held[2000:], axis=0) <= 4.0 * np.spacing(np.max(held[2000:], axis=0)))
    assert held[-1][0] != polynomial(table.axes[0].feedforward_V, 0.0)


@given(st.lists(st.tuples(*[st.floats(allow_nan=True, allow_infinity=True)] * 4), min_size=1, max_size=20))
@settings(max_examples=60, deadline=None)
def test_outputs_are_finite_and_within_limits_whatever_comes_in(samples):
    law = FloatLaw(TABLE)
    law.reset(samples[0][2], samples[0][3])
    for sample in samples:
        u_M_V, u_T_V = law.step(*sample)
        assert TABLE.axes[0].u_min_V <= u_M_V <= TABLE.axes[0].u_max_V
        assert TABLE.axes[1].u_min_V <= u_T_V <= TABLE.axes[1].u_max_V


@given(ANGLES, ANGLES, st.sampled_from([math.nan, math.inf, -math.inf]), st.integers(0, 3))
@settings(max_examples=40, deadline=None)
def test_an_input_that_is_not_finite_counts_as_the_last_accepted_one(psi_rad, phi_rad, bad, place):
    good = [0.1, -0.2, psi_rad, phi_rad]
    spoilt = list(good)
    spoilt[place] = bad
    first = law_step(TABLE, law_reset(TABLE, psi_rad, phi_rad), *good)[0]
    assert law_step(TABLE, first, *spoilt) == law_step(TABLE, first, *good)


def test_references_are_held_within_their_range():
    state = law_reset(TABLE, 0.0, 0.0)
    ends = (TABLE.axes[0].reference_max_rad, TABLE.axes[1].reference_min_rad)
    for _ in range(3):
        far, u_far_V = law_step(TABLE, state, 3.0, -9.0, 0.0, 0.0)
        near, u_near_V = law_step(TABLE, state, *ends, 0.0, 0.0)
        assert u_far_V == u_near_V
        assert (far[0].x2_rad, far[1].x2_rad) == (near[0].x2_rad, near[1].x2_rad)
        state = far


def test_reset_at_the_stop_starts_at_the_end_of_the_reference_range_without_a_kick():
    stop_rad = -math.pi / 4.0
    state = law_reset(TABLE, stop_rad, 0.0)
    end_rad = TABLE.axes[0].reference_min_rad
    _, (u_M_V, _) = law_step(TABLE, state, end_rad, 0.0, stop_rad, 0.0)
    integral_part_V = polynomial(TABLE.axes[0].q_V_rad[0], TABLE.schedule.min_rad) * (end_rad - stop_rad)
    assert u_M_V == pytest.approx(polynomial(TABLE.axes[0].feedforward_V, end_rad) + integral_part_V, rel=1e-12)


def test_prefilter_is_two_one_poles_that_answer_a_step_as_continuous_theory_says():
    T, Ts = TABLE.axes[0].prefilter_time_constant_s, TABLE.sample_period_s
    state = law_reset(TABLE, 0.0, 0.0)
    for _ in range(100):
        state, _ = law_step(TABLE, state, 0.3, 0.0, 0.0, 0.0)
    t = 100 * Ts
    assert state[0].x1_rad == pytest.approx(0.3 * (1.0 - math.exp(-t / T)), rel=1e-9)
    # The second one-pole sees the first half a sample early on average: within Ts/T of 1 - (1 + t/T) exp(-t/T).
    assert state[0].x2_rad == pytest.approx(0.3 * (1.0 - (1.0 + t / T) * math.exp(-t / T)), rel=1.5 * Ts / T)
    assert unfiltered(TABLE).axes[0].prefilter_gain(Ts) == 1.0


def test_azimuth_feedforward_follows_the_elevation_reference():
    table = unfiltered(table_for(settings_for(azimuth=(equal(-4.0), "q3_zero"))))
    for psi_ref_rad in (-0.5, 0.0, 0.6):
        _, (_, u_T_V) = law_step(table, law_reset(table, psi_ref_rad, 0.0), psi_ref_rad, 0.0, psi_ref_rad, 0.0)
        assert u_T_V == pytest.approx(polynomial(table.axes[1].feedforward_V, psi_ref_rad))


def test_saturate_gives_the_safe_voltage_for_no_number():
    law = replace(TABLE.axes[0], u_safe_V=1.25)
    assert saturate(law, math.nan) == 1.25
    assert saturate(law, math.inf) == law.u_max_V
    assert saturate(law, -math.inf) == law.u_min_V


def test_a_poisoned_state_heals_within_one_sample():
    state = law_reset(TABLE, 0.0, 0.0)
    poisoned = (replace(state[0], s=(math.nan, 1.0, 2.0, 0.0), v_V=math.inf), state[1])
    healed, (u_M_V, _) = law_step(TABLE, poisoned, 0.1, 0.0, 0.0, 0.0)
    assert math.isfinite(u_M_V)
    assert all(map(math.isfinite, (healed[0].v_V, *healed[0].s, *healed[0].w, *healed[0].e)))
