"""The float32 twin: it computes the law of records/table.py, and it stays finite and within limits whatever comes."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from codegen.law_constants import law_constants
from codegen.law_equations import law_reset, law_step
from codegen.law_frame import LawInput
from codegen.twin import Float32Scalars, Float32Twin
from design.law import FloatLaw
from records.table import AxisLaw, ControllerTable
from tests.law_tables import AXIS_STATE_FIELDS, STATE_WORDS, ce150_table, changed_axis, dense_table

PSI_RAD = 0.3


@pytest.mark.parametrize("table", [ce150_table(prefilter_time_constant_s=0.0), dense_table()], ids=["ce150", "dense"])
def test_at_constant_elevation_the_law_is_the_direct_form_of_its_polynomials(table: ControllerTable) -> None:
    """Truth: A v = Q e + (A - P) s in powers of z^-1, float64, both axes in and out of saturation, to 1e-9 V."""
    table = _unfiltered(table)
    rng = np.random.default_rng(4)
    references = np.repeat(rng.uniform(-0.05, 0.05, (40, 2)), 10, axis=0) + np.array([PSI_RAD, 0.0])
    outputs = _run_in_float64(table, references, np.broadcast_to([PSI_RAD, 0.0], references.shape))
    for axis, column, angle in ((table.axes[0], 0, PSI_RAD), (table.axes[1], 1, 0.0)):
        u_ff_V = np.polynomial.polynomial.polyval(references[:, 0], axis.feedforward_V)
        wanted = _direct_form(axis, references[:, column] - angle, u_ff_V)
        inside = (wanted > axis.u_min_V) & (wanted < axis.u_max_V)
        assert inside.mean() > 0.05
        assert np.abs(outputs[:, column] - wanted).max() < 1e-9


def test_in_double_precision_the_equations_are_those_of_the_design_stage() -> None:
    """Truth: design.law.FloatLaw, written on its own; both axes with prefilter, schedule and limits, to 1e-9 V."""
    table = ce150_table()
    rng = np.random.default_rng(13)
    references = np.repeat(rng.uniform(-0.6, 0.6, (20, 2)), 50, axis=0)
    angles = np.cumsum(np.vstack([np.zeros((1, 2)), rng.uniform(-0.004, 0.004, (999, 2))]), axis=0)
    reference_law = FloatLaw(table)
    reference_law.reset(0.0, 0.0)
    wanted = np.array([reference_law.step(*given) for given in np.hstack([references, angles]).tolist()])
    outputs = _run_in_float64(table, references, angles)
    assert np.abs(outputs - wanted).max() < 1e-9
    assert 0.1 < np.mean(outputs[:, 0] == table.axes[0].u_max_V) < 0.9


def test_an_integrating_axis_under_a_constant_error_climbs_by_q_0_e_over_1_minus_p_1_each_sample() -> None:
    """With p_0 = 0: v - v(k-1) = q_0 e + p_1 delta s, and delta s is that same climb; to 1 %."""
    table = _unfiltered(ce150_table())
    twin = Float32Twin(table)
    twin.reset(0.0, 0.0)
    u_M_V = [twin.step(0.0, 0.0, -0.001, 0.0)[0] for _ in range(1000)]
    climb_V = table.axes[0].q_V_rad[0][0] * 0.001 / (1.0 - table.axes[0].p[1][0])
    assert np.mean(np.diff(u_M_V)[500:]) == pytest.approx(climb_V, rel=1e-2)


def test_single_numbers_and_lanes_are_the_same_law_bit_for_bit() -> None:
    twin = Float32Twin(dense_table())
    inputs = np.random.default_rng(5).normal(0.0, 0.5, (200, 1, 4)).astype(np.float32)
    twin.reset(0.1, -0.2)
    one_by_one = np.array([twin.step(*row) for row in inputs[:, 0].astype(np.float64)], dtype=np.float32)
    start = twin.start(np.array([[0.1, -0.2]], dtype=np.float32).view(np.uint32))
    _, outputs = twin.run(start, inputs.view(np.uint32))
    assert np.array_equal(outputs[:, 0], one_by_one.view(np.uint32))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(st.floats(width=32), min_size=4, max_size=4), st.integers(0, 2**32))
def test_from_any_state_and_input_the_output_is_within_the_limits(numbers: list[float], seed: int) -> None:
    twin = Float32Twin(ce150_table())
    state = np.random.default_rng(seed).integers(0, 2**32, (1, STATE_WORDS), dtype=np.uint32)
    _, outputs = twin.run(state, np.array([[numbers]], dtype=np.float32).view(np.uint32))
    u_M_V, u_T_V = outputs.view(np.float32)[0, 0]
    assert 0.0 <= u_M_V <= 10.0
    assert -10.0 <= u_T_V <= 10.0


def test_a_broken_state_is_finite_after_three_samples_and_forgotten_within_fifteen_seconds() -> None:
    """At rest on the reference: |s| and |w| are back within the span of the limits, all differences at zero to 1 mV."""
    twin = Float32Twin(ce150_table())
    rng = np.random.default_rng(6)
    states = rng.integers(0, 2**32, (2000, STATE_WORDS), dtype=np.uint32)
    states, _ = twin.run(states, np.zeros((3, 2000, 4), dtype=np.uint32))
    assert np.isfinite(states.view(np.float32)).all()
    states, _ = twin.run(states, np.zeros((1497, 2000, 4), dtype=np.uint32))
    axis = states.view(np.float32)[:, : len(AXIS_STATE_FIELDS)]
    by_name = dict(zip(AXIS_STATE_FIELDS, axis.T, strict=True))
    assert np.abs(by_name["s_0_V"]).max() <= 20.0
    assert max(np.abs(by_name[name]).max() for name in ("s_1_V", "s_2_V", "w_1_V", "w_2_V")) < 1e-3


def test_a_missing_measurement_or_reference_is_replaced_by_the_last_accepted_one() -> None:
    whole, torn = Float32Twin(ce150_table()), Float32Twin(ce150_table())
    for missing in (math.nan, math.inf, -math.inf):
        for twin in (whole, torn):
            twin.reset(0.1, 0.2)
            twin.step(0.12, 0.25, 0.11, 0.21)
        assert torn.step(missing, missing, missing, missing) == whole.step(0.12, 0.25, 0.11, 0.21)


@pytest.mark.parametrize(
    ("u_V", "ticks"),
    [
        (0.0, 0),
        (10.0, 3200),
        (-10.0, -3200),
        (0.0015, 0),
        (0.0016, 1),
        (-0.0016, -1),
        (5.0, 1600),
        (99.0, 3200),
        (-math.inf, -3200),
        (math.nan, 0),
        (1e-45, 0),
        (0.0046875, 2),
    ],
)
def test_volts_become_the_nearest_pwm_tick_and_never_leave_full_scale(u_V: float, ticks: int) -> None:
    assert Float32Twin(ce150_table()).duty(1, u_V) == ticks


def test_the_scheduling_angle_is_held_within_the_range_of_the_table() -> None:
    """Beyond psi_max the coefficients stay those of psi_max: the move per error is the same at 0.75 and 0.9 rad."""
    table = _unfiltered(ce150_table())
    moves = []
    for psi_rad in (0.75, 0.9):
        twin = Float32Twin(table)
        twin.reset(psi_rad, 0.0)
        before = twin.step(0.5, 0.0, psi_rad, 0.0)[1]
        moves.append(twin.step(0.5, 0.5, psi_rad, 0.0)[1] - before)
    assert moves[0] == moves[1] != 0.0


def _unfiltered(table: ControllerTable) -> ControllerTable:
    return changed_axis(
        changed_axis(table, "elevation", prefilter_time_constant_s=0.0), "azimuth", prefilter_time_constant_s=0.0
    )


def _run_in_float64(
    table: ControllerTable, references: NDArray[np.float64], angles: NDArray[np.float64]
) -> NDArray[np.float64]:
    law: Any = law_constants(table, float)
    decisions: Any = Float32Scalars()
    state = law_reset(law, decisions, angles[0].tolist())
    outputs = []
    for given_now in np.hstack([references, angles]).tolist():
        state, voltages_V = law_step(law, decisions, state, LawInput.of(given_now))
        outputs.append(voltages_V)
    return np.array(outputs)


def _direct_form(axis: AxisLaw, e_rad: NDArray[np.float64], u_ff_V: NDArray[np.float64]) -> NDArray[np.float64]:
    """Limited u of A v = Q e + (A - P) s by powers of z^-1, from rest."""
    polyval = np.polynomial.polynomial.polyval
    delta = np.array([1.0, -1.0])
    Q = _in_z([polyval(PSI_RAD, q) for q in axis.q_V_rad], delta)
    P = _recursion_in_z([polyval(PSI_RAD, p) for p in axis.p], delta)
    A = _recursion_in_z(list(axis.a), delta)
    v, s = np.zeros(len(e_rad) + 3), np.zeros(len(e_rad) + 3)
    e = np.concatenate([np.zeros(3), e_rad])
    limited = np.empty(len(e_rad))
    for k in range(3, len(v)):
        past = slice(k - 3, k)
        v[k] = Q @ e[k - 3 : k + 1][::-1] - A[1:] @ v[past][::-1] + (A - P)[1:] @ s[past][::-1]
        limited[k - 3] = np.clip(v[k] + u_ff_V[k - 3], axis.u_min_V, axis.u_max_V)
        s[k] = limited[k - 3] - u_ff_V[k - 3]
    return limited


def _in_z(coefficients: list[float], delta: NDArray[np.float64]) -> NDArray[np.float64]:
    """Powers of z^-1 of sum c_i delta^i."""
    total, power = np.zeros(4), np.array([1.0])
    for coefficient in coefficients:
        total[: len(power)] += coefficient * power
        power = np.convolve(power, delta)
    return total


def _recursion_in_z(p: list[float], delta: NDArray[np.float64]) -> NDArray[np.float64]:
    """Powers of z^-1 of 1 - z^-1 [(1 - p_0) + p_1 delta + p_2 delta^2]."""
    return np.concatenate([[1.0], -_in_z([1.0 - p[0], p[1], p[2]], delta)[:3]])
