"""The second rig, free of effects, is the CE150 of equations (4) to (9); its dry friction is what its law says."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from blind.rigs.second.controller import CONTROLLERS, draw_controller, linear, stable
from blind.rigs.second.lab import PERIODS_S, draw_bench
from blind.rigs.second.manoeuvre import LIVELY, QUIET, reference
from blind.rigs.second.simulation import FASTEST_RAD_S, PRESLIDING, ROUNDED, STICK_SLIP, bearing
from blind.simulation.ce150 import Rig
from blind.simulation.record import Loss, Model, Record
from blind.simulation.rest import rest
from tests.blind.second_rig import NOMINAL, PLAIN, SMOOTH, bench_of, calm_style, flown, lab_of
from tests.soak import SOAK

MAIN_REST_V = {-40: 4.859, -30: 5.191, -20: 5.424, -10: 5.562, 0: 5.607}
ONE_OF_EACH = (0, 1, 11)  # seeds of controllers
LIVELY_STYLE = calm_style("s-curves", (0.4, 1.2), (0.6, 2.0))


def equations(rig: Rig, x: np.ndarray, u_V: np.ndarray, rounding_rad_s: float) -> np.ndarray:
    """Seed 000, equations (4) to (9), odd extension, sgn(v) = tanh(v / rounding); x (6, runs), u_V (2, runs)."""
    psi, psi_dot, _, phi_dot, w_M, w_T = x
    v = {name: rig.value(name) for name in rig.values if rig.values[name].size == 1}
    p = {name: np.polynomial.Polynomial(rig.values[name]) for name in ("p_bM", "p_bT", "p_FM", "p_FT")}
    F_M, F_T = (np.sign(w) * p[name](np.abs(w)) for name, w in (("p_FM", w_M), ("p_FT", w_T)))
    swing = v["cf_sign"] * v["cf_length"] * v["tau_gE"] / (2.0 * v["g"]) * phi_dot**2 * np.sin(2.0 * psi)
    sgn_E, sgn_A = np.tanh(psi_dot / rounding_rad_s), np.tanh(phi_dot / rounding_rad_s)
    tau_E = v["l_M"] * F_M + swing - v["tau_gE"] * np.cos(psi) - v["b_vE"] * psi_dot - v["b_cE"] * sgn_E
    tau_E = tau_E + v["K_E"] * phi_dot * w_M * np.sin(psi)
    tau_A = (v["l_T"] * F_T - v["K_A"] * w_M) * np.cos(psi) - v["b_vA"] * phi_dot - v["b_cA"] * sgn_A
    spin_M = v["K_M"] * u_V[0] - p["p_bM"](np.abs(w_M)) * w_M
    spin_T = v["K_T"] * u_V[1] - p["p_bT"](np.abs(w_T)) * w_T
    return np.array([psi_dot, tau_E / v["J_E"], phi_dot, tau_A / (v["J_A"] * np.cos(psi)), spin_M, spin_T])


def integrated(rig: Rig, record: Record, rounding_rad_s: float) -> np.ndarray:
    """Angles (rows, 2) of the equations by an eighth-order method, anew from the recorded state each second."""
    rows, starts = record.window_rows, range(0, len(record.t_s), record.window_rows)
    x = record.apparent[::rows].T.copy()
    out = np.empty_like(record.exact_rad)
    for row in range(rows):
        out[row::rows] = x[[0, 2]].T
        u_V = record.u_V[row::rows].T
        step = solve_ivp(
            lambda t, y, u_V=u_V: equations(rig, y.reshape(6, -1), u_V, rounding_rad_s).ravel(),
            (0.0, record.period_s),
            x.ravel(),
            "DOP853",
            rtol=1e-10,
            atol=1e-12,
        )
        x = step.y[:, -1].reshape(6, len(starts))
    return out


def test_without_effects_and_friction_it_follows_the_equations_to_a_nanoradian() -> None:
    """Free 1 s runs from the same states against an independent integration; fourth order at 125 us leaves rounding
    only."""
    record = flown(lab_of(SMOOTH, 12.0 if SOAK else 4.0, LIVELY_STYLE), {})
    assert np.ptp(record.exact_rad, axis=0).min() > 0.3
    assert np.abs(integrated(SMOOTH, record, 1.0) - record.exact_rad).max() < 1e-9


def test_with_rounded_friction_it_follows_the_equations_to_a_microradian() -> None:
    """The same with b_c tanh(v / v_r), v_r = 5 mrad/s: what solving friction apart from the rest leaves."""
    rig = NOMINAL.with_values({"b_cE": np.array([1e-3]), "b_cA": np.array([1e-3])})
    record = flown(lab_of(rig, 6.0 if SOAK else 1.0, LIVELY_STYLE), {})
    assert np.abs(integrated(rig, record, PLAIN["width"][0]) - record.exact_rad).max() < 1e-6


def test_the_coarse_prediction_of_the_retune_follows_the_fine_one() -> None:
    for law, width in ((ROUNDED, 3e-3), (PRESLIDING, 1e-3), (STICK_SLIP, 1e-3)):
        lab = lab_of(NOMINAL, 8.0 if SOAK else 4.0, LIVELY_STYLE, friction=bearing(law, width, width))
        record = flown(lab, {})
        assert np.abs(lab.predict(NOMINAL, record, 5e-4) - record.shadow[:, 1]).max() < 2e-3


@pytest.mark.parametrize(("elevation_deg", "expected_V"), MAIN_REST_V.items())
def test_rest_voltages_are_the_published_ones_within_a_millivolt(elevation_deg: int, expected_V: float) -> None:
    volts, _ = rest(NOMINAL, np.deg2rad(elevation_deg), FASTEST_RAD_S)
    assert volts[0] == pytest.approx(expected_V, abs=1e-3)
    assert 1.80 <= volts[1] <= 1.97


def released(law: int, width: float, torque_Nm: float) -> tuple[np.ndarray, np.ndarray]:
    """(times, azimuth) at rest with friction of 2e-3 N m, no weight, no rotor that turns; a push from 1 s before on."""
    rig = NOMINAL.with_values({"b_cA": np.array([2e-3]), "tau_gE": np.zeros(1), "b_vA": np.zeros(1)})
    push = {("pulse_Nm", 1): torque_Nm, ("pulse_start_s", 1): -1.0, ("pulse_s", 1): 100.0, ("pulse_rise", 1): 1e-4}
    calm = calm_style("holding", (0.0, 0.0), (0.0, 0.0))
    lab = replace(lab_of(NOMINAL, 1.0, calm, friction=bearing(law, width, width)), nominal=rig)
    lab.control.gain, lab.control.feed_V = [[0.0] * 4] * 2, [[0.0] * 3] * 2
    model = Model(rig, push)
    record = lab.fly(model, [model], lab.inputs(np.random.default_rng(0), Loss(), 0))
    return record.t_s, record.exact_rad[:, 1]


def test_a_bearing_that_sticks_does_not_move_at_all_below_its_level_and_slips_above() -> None:
    """Truth: rest below 2e-3 N m; above, acceleration (torque - level) / J_A, within 1 % of the way it goes in 1 s."""
    _, held = released(STICK_SLIP, 1e-3, 1.9e-3)
    assert np.ptp(held) == 0.0
    t_s, free = released(STICK_SLIP, 1e-3, 2.1e-3)
    speed = np.gradient(free, t_s)
    acceleration = (speed[-2] - speed[1]) / (t_s[-2] - t_s[1])
    assert acceleration == pytest.approx(1e-4 / NOMINAL.value("J_A"), rel=0.01)


def test_a_rounded_bearing_creeps_at_the_speed_where_it_balances_the_push() -> None:
    """Truth: v = v_r atanh(torque / level), within 1 %."""
    t_s, path = released(ROUNDED, 5e-3, 1e-3)
    assert (path[-1] - path[50]) / (t_s[-1] - t_s[50]) == pytest.approx(5e-3 * np.arctanh(0.5), rel=0.01)


def test_a_presliding_bearing_comes_back_when_the_push_does_not_reach_its_level() -> None:
    """Truth: energy of the bristle (Dahl): it swings between bounds below two widths, and it swings."""
    _, path = released(PRESLIDING, 1e-3, 1e-3)
    assert 1e-5 < np.ptp(path) < 2e-3


def test_the_shadow_of_the_rig_itself_repeats_it_exactly_in_still_air() -> None:
    hidden = {
        ("step_V", 1): 0.3, ("sensor_delay_s", 0): 0.02, ("sensor_spread", 0): 0.2,
        ("maxwell_Nm_rad", -1): 5e-3, ("maxwell_s", -1): 0.5,
        ("mass_share", 1): 0.4, ("mass_rad_s", 1): 30.0, ("mass_zeta", 1): 0.05, ("mass_reads", 1): 1.0,
        ("delay_s", 0): 0.02,
        ("delay_spread", 0): 0.2, ("spin_inertia", 0): 4e-5, ("spin_soft_s", 0): 0.01,
    }  # fmt: skip
    for law, width in ((ROUNDED, 3e-3), (PRESLIDING, 1e-3), (STICK_SLIP, 1e-3)):
        record = flown(lab_of(NOMINAL, 4.0, LIVELY_STYLE, friction=bearing(law, width, width)), hidden)
        np.testing.assert_array_equal(record.shadow[:, 0], record.exact_rad)


def test_every_kind_of_controller_holds_an_arm_that_is_heavier_than_stated_where_it_is_told() -> None:
    """Gravity 5 % more: without its integral each would stay 20 mrad below; 5 mrad are left after 23 s. A draw of each kind and period."""
    heavy = Model(SMOOTH.with_values({"tau_gE": 1.05 * SMOOTH.values["tau_gE"]}), {})
    seen = {}
    for seed in range(12) if SOAK else ONE_OF_EACH:
        period_s = PERIODS_S[seed % len(PERIODS_S)]
        kind, _ = draw_controller(SMOOTH, period_s, np.random.default_rng(seed))
        lab = lab_of(SMOOTH, 20.0, calm_style("holding", (0.0, 0.0), (0.0, 0.0)), period_s=period_s, seed=seed)
        record = lab.fly(heavy, [], lab.inputs(np.random.default_rng(0), Loss(), 0))
        seen[kind] = max(seen.get(kind, 0.0), np.abs(record.exact_rad[-round(1.0 / period_s) :]).max())
    assert set(seen) == set(CONTROLLERS)
    assert max(seen.values()) < 5e-3, seen


def test_a_loop_with_the_wrong_sign_or_far_too_much_gain_is_not_taken_for_stable() -> None:
    """Truth: gravity turns the arm over above the horizontal; negated it falls, thirty-fold the rotor's lag is too
    long."""
    good = np.array([3.8, 2.3, 2.0, 0.0])
    assert stable(NOMINAL, "pid", 0, good, 0.01, 0.03)
    assert not stable(NOMINAL, "pid", 0, -good, 0.01, 0.03)
    assert not stable(NOMINAL, "pid", 0, 30.0 * good, 0.01, 0.03)


def test_the_linear_model_is_the_slope_of_the_equations() -> None:
    """Central differences of the equations about rest at 0.2 rad, within 1e-6 of each entry."""
    volts, speeds = rest(SMOOTH, 0.2, FASTEST_RAD_S)
    x = np.array([0.2, 0.0, 0.0, 0.0, *speeds])
    for axis, states in ((0, (0, 1, 4)), (1, (2, 3, 5))):
        A, B = linear(SMOOTH, axis, 0.2)
        for column, state in enumerate(states):
            step = np.zeros(6)
            step[state] = 1e-4
            up, down = (equations(SMOOTH, x + s * step, volts, 1.0) for s in (1.0, -1.0))
            found = (up - down)[list(states)] / 2e-4
            # The azimuth's tail rotor lifts with cos(Psi) on both sides of (9), the elevation's gravity bends its own.
            np.testing.assert_allclose(found, A[:, column], rtol=1e-5, atol=1e-6)
        assert B[2, 0] == NOMINAL.value(("K_M", "K_T")[axis])


@pytest.mark.parametrize("kind", sorted({*LIVELY, *QUIET}))
def test_a_reference_stays_within_reach_and_has_no_jumps(kind: str) -> None:
    """Within 1.25 of the reach (a doublet about a shifted middle), and no faster than 40 reaches per second."""
    t_s = np.arange(0.0, 50.0, 0.01)
    for seed in range(6):
        asked = reference(kind, np.random.default_rng(seed), t_s, seed % 2, kind in LIVELY, 0.4)
        assert np.abs(asked).max() <= 1.25 * 0.4
        assert np.abs(np.diff(asked)).max() < 40.0 * 0.4 * 0.01
        assert np.ptp(asked) > 0.01


def test_what_is_drawn_spans_what_is_promised() -> None:
    """Draws: every period, count of encoder and number of runs; parameters within 3 of the stated sd and of their
    sign."""
    benches = [bench_of(draw_bench, seed, excited=seed % 2 == 0) for seed in range(60 if SOAK else 24)]
    assert {bench.logging.period_s for bench in benches} == set(PERIODS_S)
    assert {bench.training for bench in benches} == {1, 2, 3}
    assert {round(2.0 * np.pi / q) for bench in benches for q in bench.nominal.resolution_rad} == {
        1024,
        2048,
        4096,
        8192,
    }
    assert 0.1 < np.mean([bench.logging.start_s > 0.0 for bench in benches]) < 0.5
    assert {bench.lab.bearing["law"][0] for bench in benches} == {ROUNDED, PRESLIDING, STICK_SLIP}
    deviations = []
    for bench in benches:
        assert 45.0 <= bench.logging.length_s <= 75.0
        assert 0.5 <= bench.nominal.sds["J_E"][0] / NOMINAL.sds["J_E"][0] <= 2.0
        assert len(set(bench.lab.style.manoeuvres)) == bench.training + 1
        for name, sd in bench.nominal.sds.items():
            known, true = bench.nominal.values[name], bench.true.values[name]
            assert np.all(np.abs(true - known) <= 3.0 * sd + 1e-15)
            assert np.all(true * np.sign(known) >= 0.0)
            deviations += list(
                ((true - known)[sd > 0.0] / sd[sd > 0.0]) if name.startswith(("p_", "J_", "K_M")) else []
            )
    assert np.std(deviations) == pytest.approx(0.987, abs=0.08)
