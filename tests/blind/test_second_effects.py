"""Each effect of the second rig against its formula in plain numbers, part by part; every one is felt in a flight."""

from collections.abc import Mapping

import numpy as np
import pytest

from blind.effect import Effect, Visited
from blind.record import Loss, Record
from blind.rigs import RIGS
from blind.second.effects import CATALOGUE
from blind.second.simulation import PRESLIDING, ROUNDED, STEP_S, STICK_SLIP, Bearing
from tests.blind.second_rig import NOMINAL, SMOOTH, Part, calm_style, flown, lab_of

Settings = Mapping[tuple[str, int], float]
ALL = (*CATALOGUE.known, *CATALOGUE.timing, *CATALOGUE.outside)
# The others act through lost commands, the rig's own friction, or the counts.
SIMULATED = [e for e in ALL if not e.loss and not e.coulomb and not e.name.endswith("sensor.quantization")]
J_E, J_A, L, K_M, K_T = (NOMINAL.value(name) for name in ("J_E", "J_A", "l_M", "K_M", "K_T"))
TAU_G = NOMINAL.value("tau_gE")
# psi psi' phi phi' omega_M omega_T
X = [0.3, 0.5, -0.4, 0.8, 340.0, 250.0]
C, S = np.cos(0.3), np.sin(0.3)


def thrust(rotor: str, w: float) -> float:
    return float(np.sign(w) * np.polynomial.Polynomial(NOMINAL.values[f"p_F{rotor}"])(abs(w)))


F_M, F_T = thrust("M", 340.0), thrust("T", 250.0)
CHEESEMAN = 1.0 / (1.0 - 0.1 / 1.1 / (1.0 + 1.5 * (np.sin(0.3) + np.sin(np.pi / 4))) ** 2) - 1.0

# Settings, added torque on elevation and on azimuth in N m at the state X and 4 s.
TORQUES: list[tuple[Settings, float, float]] = [
    ({("ground", -1): 0.1, ("ground_reach", -1): 1.5}, L * F_M * CHEESEMAN, 0.0),
    ({("flutter", -1): 0.05, ("flutter_rad_s", -1): 360.0, ("flutter_width_rad_s", -1): 20.0}, -0.05 * np.exp(-1) * L * F_M, 0.0),
    ({("flap", -1): 4e-3}, 0.0, 4e-3 * F_M * 0.5 * C),
    ({("downwash", -1): 0.1, ("downwash_power", -1): 1.5}, 0.0, L * F_T * C * (np.exp(-0.1 * (340 / 600) ** 1.5) - 1)),
    ({("chip", -1): 0.1, ("chip_time_s", -1): 3.9}, 0.0, -0.1 * L * F_T * C),
    ({("chip", -1): 0.1, ("chip_time_s", -1): 4.1}, 0.0, 0.0),
    ({("vortex", -1): 0.2, ("vortex_rad_s", -1): 0.6, ("vortex_width_rad_s", -1): 0.2}, 0.0, -0.2 * np.exp(-1) * L * F_T * C),
    ({("reverse", -1): -0.2, ("reverse_rad_s", -1): 20.0}, 0.0, 0.0),
    ({("drag", 0): 2e-3, ("drag_power", 0): 1.8}, -2e-3 * 0.5**1.8, 0.0),
    ({("drag", 1): 2e-3, ("drag_power", 1): 2.3}, 0.0, -2e-3 * 0.8**2.3),
    ({("spring", 0): 3e-3, ("spring_zero_rad", 0): 0.1, ("spring_slack", 0): 0.7, ("spring_growth", 0): 0.5}, -3e-3 * 0.2 * 1.1, 0.0),
    ({("spring", 1): 3e-3, ("spring_zero_rad", 1): 0.1, ("spring_slack", 1): 0.7, ("spring_growth", 1): 0.5}, 0.0, 3e-3 * 0.7 * 0.5 * 1.25),
    ({("spin_inertia", 0): 4e-5, ("spin_soft_s", 0): 0.01}, -4e-5 * 250.0 / 0.01, 0.0),
    ({("spin_inertia", 1): 4e-5, ("spin_soft_s", 1): 0.01}, 0.0, -4e-5 * 340.0 / 0.01 * C),
    ({("pulse_Nm", 0): 4e-3, ("pulse_start_s", 0): 3.0, ("pulse_s", 0): 10.0, ("pulse_rise", 0): 0.2}, 2e-3, 0.0),
    ({("pulse_Nm", 1): 4e-3, ("pulse_start_s", 1): 1.0, ("pulse_s", 1): 10.0, ("pulse_rise", 1): 0.2}, 0.0, 4e-3),
    ({("pulse_Nm", 1): 4e-3, ("pulse_start_s", 1): 1.0, ("pulse_s", 1): 3.0, ("pulse_rise", 1): 0.2}, 0.0, 0.0),
    ({("drift_Nm_s", 0): 1e-4}, 4e-4, 0.0),
    ({("centre_rad", -1): 0.06, ("centre_droop", -1): 0.2}, TAU_G * (C - np.cos(0.3 + 0.06 * (1 + 0.2 * C))), 0.0),
    ({("weight", -1): 0.1, ("weight_time_s", -1): 3.5, ("weight_slide_s", -1): 1.0}, -0.05 * TAU_G * C, 0.0),
    ({("weight", -1): 0.1, ("weight_time_s", -1): 2.0, ("weight_slide_s", -1): 1.0}, -0.1 * TAU_G * C, 0.0),
    ({("tail_lift", -1): 2e-4, ("tail_lift_power", -1): 1.8}, 2e-4 * 2.5**1.8, 0.0),
    ({("maxwell_Nm_rad", -1): 5e-3, ("maxwell_s", -1): 1.0}, -5e-3 * 0.3, 0.0),
    ({("lean_Nm", -1): 4e-3, ("lean_rad", -1): 0.2}, -4e-3 * S * np.cos(0.6), 0.0),
    ({("tilt_Nm", -1): 3e-3, ("tilt_rad", -1): 0.2}, 0.0, 3e-3 * C * np.sin(0.6)),
    ({("gyro_azimuth", -1): 3e-5, ("gyro_cant_rad", -1): 0.05}, 0.0, -3e-5 * 0.5 * 340.0 * np.sin(0.35)),
    ({("magnet_Nm", -1): 3e-3, ("magnet_rad", -1): -0.6, ("magnet_width_rad", -1): 0.2}, 0.0, -3e-3),
    ({("eddy_Nms", -1): 5e-3, ("eddy_rad_s", -1): 0.4}, 0.0, -5e-3 * 0.8 / 5.0),
]  # fmt: skip


@pytest.mark.parametrize(("settings", "elevation_Nm", "azimuth_Nm"), TORQUES, ids=lambda value: str(value)[:40])
def test_a_torque_is_the_one_of_its_formula(settings: Settings, elevation_Nm: float, azimuth_Nm: float) -> None:
    added = Part(settings, X, 4.0).slope() - Part({}, X, 4.0).slope()
    np.testing.assert_allclose([J_E * added[1], J_A * C * added[3]], [elevation_Nm, azimuth_Nm], rtol=1e-9, atol=1e-15)


def test_reversed_blades_lose_their_share_once_the_flow_is_established() -> None:
    x = [*X[:5], -60.0]
    added = Part({("reverse", -1): -0.2, ("reverse_rad_s", -1): 20.0}, x).slope() - Part({}, x).slope()
    assert J_A * added[3] == pytest.approx(-0.2 * 0.9 * L * thrust("T", -60.0), rel=1e-9)


def test_stale_air_takes_the_lift_that_it_has_followed() -> None:
    """Truth: (1 - exp(-t / T)) of the thrust after t = T, times the share, is missing."""
    part = Part({("stale", -1): 0.1, ("stale_s", -1): 2.0}, X)
    part.state.stale_N = F_M * (1.0 - np.exp(-1.0))
    added = part.slope() - Part({}, X).slope()
    assert J_E * added[1] == pytest.approx(-0.1 * 0.632 * L * F_M, rel=1e-3)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("reads", [0.0, 1.0])
def test_two_masses_pull_at_each_other_and_together_weigh_what_one_did(axis: int, reads: float) -> None:
    """Truth: spring of J s (1 - s) omega^2, equal and opposite; the sum of torques is the rigid arm's but for its bearing's drag."""
    x = [0.0, 0.0, 0.0, 0.0, 340.0, 250.0, 0.0, 0.0, 0.0, 0.0]
    x[2 * axis] = 0.02
    settings = {
        ("mass_share", axis): 0.3,
        ("mass_rad_s", axis): 20.0,
        ("mass_zeta", axis): 0.05,
        ("mass_reads", axis): reads,
    }
    inertia = (J_E, J_A * np.cos(x[0]))[axis]
    rigid, two = Part({}, x).slope(), Part(settings, x).slope()
    force = (J_E, J_A)[axis] * 0.3 * 0.7 * 400.0 * 0.02
    assert 0.3 * inertia * two[7 + 2 * axis] == pytest.approx(force, rel=1e-9)
    total = inertia * (0.7 * two[1 + 2 * axis] + 0.3 * two[7 + 2 * axis])
    assert total == pytest.approx(inertia * rigid[1 + 2 * axis], rel=1e-9)


@pytest.mark.parametrize(
    ("settings", "sent_V", "expected_V"),
    [
        ({("dead_V", 0): 0.3, ("dead_knee", 0): 0.2}, (5.0, 2.0), (4.7, 2.0)),
        ({("dead_V", 1): 1.0, ("dead_knee", 1): 0.2, ("dead_skew", 1): 0.1}, (5.0, -2.0), (5.0, -1.1)),
        ({("dead_V", 1): 1.0, ("dead_knee", 1): 0.2}, (5.0, 0.8), (5.0, 0.0)),
        ({("dead_V", 1): 1.0, ("dead_knee", 1): 0.2}, (5.0, 1.0), (5.0, 0.05)),
        ({("limit_V", 0): 6.0, ("limit_knee", 0): 0.1}, (5.3, 2.0), (5.3, 2.0)),
        ({("limit_V", 0): 6.0, ("limit_knee", 0): 0.1}, (6.0, 2.0), (5.4 + 0.6 * np.tanh(1.0), 2.0)),
        ({("limit_V", 1): 4.0, ("limit_knee", 1): 0.1}, (5.0, -9.0), (5.0, -4.0)),
        ({("sag", 0): 0.1, ("supply_s", -1): 0.05}, (6.0, -2.0), (6.0 / 1.08, -2.0)),
        ({("sag", 1): 0.1, ("supply_s", -1): 0.05}, (6.0, -2.0), (6.0, -2.0 / 1.08)),
        ({("bias_V", 1): 0.2}, (5.0, 2.0), (5.0, 2.2)),
        ({("cross", 1): 0.03}, (5.0, 2.0), (5.0, 2.15)),
        ({("step_V", 0): 0.5}, (5.2, 2.0), (5.2, 2.0)),
    ],
)
def test_a_driver_gives_the_voltage_of_its_formula(settings: Settings, sent_V: tuple, expected_V: tuple) -> None:
    """A command that stands for long; a quantised one that was there before keeps its level, see the next test."""
    part = Part(settings)
    part.settle(*sent_V)
    np.testing.assert_allclose(part.drive(1.0), expected_V, atol=1e-6)


def answer_V(settings: Settings, seconds: float, rotor: int = 0) -> float:
    """Voltage so long after a step from 4 to 6 V at both inputs."""
    part = Part(settings)
    part.settle(4.0, 4.0)
    part.command(6.0, 6.0)
    return float(part.drive(seconds)[rotor])


@pytest.mark.parametrize("rotor", [0, 1])
def test_a_driver_answers_a_step_as_late_as_its_formula_says(rotor: int) -> None:
    """Steps of 125 us: times within one of them."""
    delay = {("delay_s", rotor): 0.02}
    assert (answer_V(delay, 0.0195, rotor), answer_V(delay, 0.0205, rotor)) == (4.0, 6.0)
    spread = {**delay, ("delay_spread", rotor): 0.25}
    assert (answer_V(spread, 0.0148, rotor), answer_V(spread, 0.0252, rotor)) == (4.0, 6.0)
    slew = {("slew_V_s", rotor): 10.0, ("slew_skew", rotor): 0.1}
    assert answer_V(slew, 0.1, rotor) == pytest.approx(5.1, abs=0.002)
    lag = {("lag_s", rotor): 0.1, ("lag_split", rotor): 0.7}
    exact = 6.0 - 2.0 * (0.07 * np.exp(-0.1 / 0.07) - 0.03 * np.exp(-0.1 / 0.03)) / 0.04
    assert answer_V(lag, 0.1, rotor) == pytest.approx(exact, abs=0.003)
    steps = {("step_V", rotor): 0.8, ("step_hold", rotor): 0.1}
    assert answer_V(steps, 0.1, rotor) == pytest.approx(6.4)


def test_steps_with_a_memory_leave_a_level_late() -> None:
    """Truth: 1 V steps, 0.2 V of memory: 5.6 V is nearer to 6 V, but 5 V holds until 5.7 V is passed."""
    part = Part({("step_V", 0): 1.0, ("step_hold", 0): 0.2})
    part.settle(5.0, 2.0)
    for volts, expected in ((5.6, 5.0), (5.8, 6.0), (5.4, 6.0), (5.2, 5.0)):
        part.command(volts, 2.0)
        assert part.drive(0.01)[0] == expected


def test_both_inputs_are_late_alike_where_the_loop_is() -> None:
    effect = next(effect for effect in CATALOGUE.timing if effect.name == "loop.delay")
    part = Part(effect.settings(2.0, {"spread": 0.2}))
    part.settle(4.0, 4.0)
    for _ in range(200):
        part.command(6.0, 6.0)
        volts = part.drive(STEP_S)
        assert volts[0] == volts[1]
    assert part.drive(0.03)[0] == 6.0


def test_a_supply_that_dips_does_so_for_its_share_of_the_time() -> None:
    for rotor, spread in ((0, 0.0), (1, 1.0)):
        settings = {
            ("dip", rotor): 0.5,
            ("dip_every_s", rotor): 1.0,
            ("dip_long_s", rotor): 0.2,
            ("dip_spread", rotor): spread,
        }
        part = Part(settings)
        part.settle(4.0, 4.0)
        volts = np.array([part.drive(0.01)[rotor] for _ in range(1000)])
        assert set(volts) == {2.0, 4.0}
        assert np.mean(volts == 2.0) == pytest.approx(0.2, abs=0.02)


@pytest.mark.parametrize("rotor", [0, 1])
def test_a_warming_drive_falls_by_its_two_shares(rotor: int) -> None:
    """Truth: a (s (1 - exp(-t/T1)) + (1 - s)(1 - exp(-t/T2))) of K u at t = 10 s."""
    settings = {
        ("warm", rotor): 0.2,
        ("warm_fast_s", rotor): 5.0,
        ("warm_slow_s", rotor): 20.0,
        ("warm_share", rotor): 0.4,
    }
    part, plain = Part(settings, t_s=10.0), Part({})
    for each in (part, plain):
        each.state.volts = [5.0, 5.0]
    lost = (plain.slope() - part.slope())[4 + rotor] / (5.0 * (K_M, K_T)[rotor])
    assert lost == pytest.approx(0.2 * (0.4 * (1 - np.exp(-2.0)) + 0.6 * (1 - np.exp(-0.5))), rel=1e-9)


def test_a_slipping_hub_accelerates_no_faster_than_it_can() -> None:
    part = Part({("clutch_rad_s2", -1): 300.0})
    part.state.volts = [10.0, 0.0]
    assert part.slope()[4] == pytest.approx(300.0, rel=1e-4)


@pytest.mark.parametrize(
    ("settings", "rotor", "t_s", "expected"),
    [
        ({("dry", 0): 30.0, ("dry_round_rad_s", 0): 3.0}, 0, 0.0, 30.0 * (1 + 0.4 / (1 + 13.6**2))),
        ({("dry", 1): 30.0, ("dry_round_rad_s", 1): 3.0}, 1, 0.0, 30.0 * (1 + 0.4 / 101.0)),
        ({("seize", 1): 2.0, ("dry_round_rad_s", 1): 3.0}, 1, 10.0, 20.0 * (1 + 0.4 / 101.0)),
    ],
)
def test_a_dry_rotor_brakes_as_its_formula_says(settings: Settings, rotor: int, t_s: float, expected: float) -> None:
    """rad/s^2 at 340 and 250 rad/s, the slowing over one step."""
    part = Part(settings, X, t_s)
    part.lib.rotor_brake(part.effects, part.state, STEP_S)
    assert (X[4 + rotor] - part.state.x[4 + rotor]) / STEP_S == pytest.approx(expected, rel=1e-6)


LEVELS: list[tuple[Settings, int, float, float]] = [
    ({}, 0, 0.5, 2e-4),
    ({}, 1, 0.8, 3e-4),
    ({("stribeck_Nm", 0): 1e-3, ("stribeck_rad_s", 0): 0.25}, 0, 0.5, 2e-4 + 1e-3 / 5.0),
    ({("stribeck_Nm", 1): 1e-3, ("stribeck_rad_s", 1): 0.4}, 1, 0.8, 3e-4 + 1e-3 / 5.0),
    ({("asymmetry_Nm", 1): 4e-4}, 1, 0.8, 7e-4),
    ({("asymmetry_Nm", 1): -4e-4}, 1, 0.8, 3e-4),
    ({("spot_Nm", -1): 1e-3, ("spot_rad", -1): 0.2, ("spot_width_rad", -1): 0.05}, 0, 0.5, 2e-4 + 1e-3 / 5.0),
    ({("brush_Nm", -1): 1e-3, ("brush_rad", -1): -0.4}, 1, 0.8, 3e-4 + 1e-3),
]


@pytest.mark.parametrize(("settings", "axis", "rate", "level_Nm"), LEVELS)
def test_a_bearing_drags_with_the_level_of_its_formula_whatever_the_law(
    settings: Settings, axis: int, rate: float, level_Nm: float
) -> None:
    """Torque at the state X, from the slowing over a step; the bristle is stretched to the full."""
    inertia = (J_E, J_A * C)[axis]
    for law, width in ((ROUNDED, 5e-3), (PRESLIDING, 1e-3), (STICK_SLIP, 1e-3)):
        part = Part(settings, X)
        part.state.bristle = [1e-3, 1e-3]
        after = part.rub(Bearing((law, law), (width, width)))[1 + 2 * axis]
        assert (rate - after) / STEP_S * inertia == pytest.approx(level_Nm, rel=1e-6)


PATH = np.concatenate([np.linspace(0.0, 0.4, 4000), np.linspace(0.4, 0.1, 3000)])


@pytest.mark.parametrize("axis", [0, 1])
def test_an_encoder_bends_the_angle_as_its_formula_says(axis: int) -> None:
    still = np.full(10, 0.4)
    offset = {("offset_rad", axis): 0.03, ("offset_swing", axis): 0.1}
    assert Part(offset).shown(still, axis)[-1] == pytest.approx(0.43 + 0.003 * np.sin(0.4))
    scale = {("scale_error", axis): 0.05, ("scale_bend", axis): 0.2}
    assert Part(scale).shown(still, axis)[-1] == pytest.approx(0.4 * (1.0 + 0.05 * 1.08))
    pickup = Part({("pickup_rad_V", axis): 3e-3})
    pickup.state.volts = [5.0, 5.0]
    assert pickup.shown(still, axis)[-1] == pytest.approx(0.415)
    assert Part({("wander_rad_s", axis): 2e-3}, t_s=10.0).shown(still, axis)[-1] == pytest.approx(0.42, abs=1e-5)


@pytest.mark.parametrize("axis", [0, 1])
def test_an_encoder_is_late_as_its_formula_says(axis: int) -> None:
    """On a ramp of 0.8 rad/s that has gone on for half a second: late by the delay or the whole lag."""
    for settings, late_s in (
        ({("sensor_delay_s", axis): 0.02}, 0.02),
        ({("sensor_lag_s", axis): 0.02, ("sensor_split", axis): 0.7}, 0.02),
    ):
        behind = (PATH - Part(settings).shown(PATH, axis))[3900] / 0.8
        assert behind == pytest.approx(late_s, abs=2.0 * STEP_S)
    spread = Part({("sensor_delay_s", axis): 0.02, ("sensor_spread", axis): 0.2}).shown(PATH, axis)
    behind = (PATH - spread)[1000:3900] / 0.8
    assert 0.0155 < behind.min() < 0.018 < 0.022 < behind.max() < 0.0245
    assert behind.mean() == pytest.approx(0.02, abs=1e-3)


@pytest.mark.parametrize("axis", [0, 1])
def test_play_takes_its_mean_width_from_a_reversal(axis: int) -> None:
    """Truth: 5 mrad behind on the way up, 5 mrad ahead on the way down, for a width of 10 mrad; nothing moves for the lesser play."""
    shown = Part({("backlash_rad", axis): 0.01, ("backlash_split", axis): 0.3}).shown(PATH, axis)
    assert (PATH - shown)[3999] == pytest.approx(5e-3, abs=1e-6)
    assert (shown - PATH)[-1] == pytest.approx(5e-3, abs=1e-6)
    assert np.sum(np.diff(shown[3999:]) == 0.0) == pytest.approx(0.007 / 1e-4, abs=2)


def test_lines_that_pass_too_fast_are_missed() -> None:
    """Truth: 0.1 of what goes beyond 0.3 rad/s, for half a second at 0.8 rad/s."""
    shown = Part({("missed", 1): 0.1, ("missed_rad_s", 1): 0.3}).shown(PATH[:4000], 1)
    assert (PATH[3999] - shown[-1]) == pytest.approx(0.1 * 0.5 * 0.5, abs=1e-4)


def test_a_coarse_encoder_gives_multiples_of_its_step_and_holds_them_beyond_the_edge() -> None:
    """Through the stated steps of 2 pi / 4096: never further from a multiple than half of one; up and down differ by 2 holds."""
    part = Part({("count_rad", 1): 0.02, ("count_hold", 1): 0.15})
    edges = []
    for angles in (np.linspace(0.001, 0.019, 181), np.linspace(0.019, 0.001, 181)):
        counts = []
        for angle in angles:
            part.state.read = [0.0, angle]
            counts.append(part.lib.sensor_count(part.rig, part.effects, part.state, 1))
        assert np.abs(np.array(counts) - 0.02 * np.round(np.array(counts) / 0.02)).max() <= np.pi / 4096 + 1e-12
        edges.append(angles[np.flatnonzero(np.diff(counts))[0]])
    assert edges[0] - edges[1] == pytest.approx(2 * 0.15 * 0.02, abs=3e-4)


def test_knocks_come_one_in_each_stretch_of_time_and_last_sixty_milliseconds() -> None:
    for axis in (0, 1):
        settings = {("knock_Nm", axis): 6e-3, ("knock_every_s", axis): 1.0}
        kicks = np.array([Part(settings, t_s=t).state.outer_Nm[axis] for t in np.arange(0.0, 20.0, 0.005)])
        assert np.abs(kicks).max() == pytest.approx(6e-3, rel=0.02)
        assert np.mean(kicks != 0.0) == pytest.approx(0.06, abs=0.01)
        assert kicks.min() < 0.0 < kicks.max()


def test_lost_commands_leave_the_last_one_in_force_alone_or_in_bursts() -> None:
    """Share within 5 points over 20 s; the mean burst within a fifth."""
    style = calm_style("s-curves", (0.3, 1.0), (0.3, 1.0))
    lab = lab_of(SMOOTH, 60.0, style)
    for burst, expected in ((1.0, 1.0 / 0.7), (5.0, 5.0)):
        lost = lab.flight(np.random.default_rng(1), Loss(0.3, burst), 0).lost[300:]
        assert np.mean(lost) == pytest.approx(0.3, abs=0.05)
        assert lost.sum() / np.sum(np.diff(lost.astype(int)) == 1) == pytest.approx(expected, rel=0.2)
    assert not lab.flight(np.random.default_rng(1), Loss(), 0).lost.any()


LIVELY_STYLE = calm_style("s-curves", (0.42, 1.3), (0.6, 8.0))
LIVELY = lab_of(NOMINAL, 5.0, LIVELY_STYLE)


@pytest.mark.parametrize("effect", SIMULATED, ids=lambda effect: effect.name)
def test_every_effect_is_felt(effect: Effect) -> None:
    """At four times its reference size (within bounds) an excited run's free predictions differ by more than 1e-4 rad."""
    shape = effect.draw(np.random.default_rng(1))
    early = {key: 1.55 if key in ("start_s", "time_s") and value > 4.0 else value for key, value in shape.items()}
    record = flown(LIVELY, effect.settings(float(np.clip(4.0, *effect.bounds)), early), placed=effect.sensor)
    assert not record.failed
    assert np.abs(record.shadow[:, 1] - record.shadow[:, 0]).max() > 1e-4


def test_the_same_rows_of_the_table_are_covered_as_by_the_first_rig_and_fifteen_and_more_lie_outside() -> None:
    first, second = ({e.name for e in (*k.catalogue.known, *k.catalogue.timing)} for k in RIGS.values())
    assert first == second
    outside = [effect.name for effect in CATALOGUE.outside]
    assert len(set(outside)) == len(outside) >= 15
    assert not {effect.name for effect in RIGS["first"].catalogue.outside} & set(outside)
    assert not first & set(outside)
    assert not any(effect.known for effect in CATALOGUE.outside)


@pytest.fixture(scope="module")
def visited() -> Visited:
    record: Record = flown(LIVELY, {})
    a, p_FT = record.apparent, np.polynomial.Polynomial(NOMINAL.values["p_FT"])
    u = record.u_V
    return Visited(record.t_s * 6.0, *a.T[:6], u[:, 0], u[:, 1], TAU_G, lambda w: np.sign(w) * p_FT(np.abs(w)), 100.0)


@pytest.mark.parametrize("effect", [*CATALOGUE.known, *CATALOGUE.timing], ids=lambda effect: effect.name)
def test_every_library_effect_has_finite_parameters_in_the_librarys_formula(effect: Effect, visited: Visited) -> None:
    found = effect.equivalent(1.0, effect.draw(np.random.default_rng(2)), visited)
    assert any(entry.main for entry in found.values())
    for entry in found.values():
        assert np.isfinite(entry.value)
        assert entry.scale > 0.0


@pytest.mark.parametrize(
    ("name", "shape", "symbol", "expected"),
    [
        ("main_input.deadzone", {"knee": 0.1, "skew": 0.0}, "d", 0.25),
        ("main_input.saturation", {"knee": 1e-3}, "limit", 7.2),
        ("tail_input.saturation", {"knee": 1e-3}, "limit", 4.2),
        ("main_rotor.warmup", {"fast_s": 10.0, "slow_s": 10.0, "share": 0.5}, "a", 0.05),
        ("tail_rotor.dry_friction", {"round_rad_s": 1e-3}, "c", 30.0),
        ("tail_rotor.reverse_asymmetry", {"sign": 1.0, "speed_rad_s": 1e-3}, "r", 0.8),
        ("tail_rotor.downwash", {"power": 1.0}, "a", 0.08),
        ("elevation.quadratic_drag", {"power": 2.0}, "c", 2e-3),
        ("azimuth.cable_spring", {"zero_rad": 0.3, "slack": 1.0, "growth": 0.0}, "k", 3e-3),
        ("azimuth.cable_spring", {"zero_rad": 0.3, "slack": 1.0, "growth": 0.0}, "angle_0", 0.3),
        ("elevation.disturbance", {"sign": -1.0, "start_s": 5.0, "s": 2.0, "rise": 1e-6}, "torque", -4e-3),
        ("elevation.disturbance", {"sign": -1.0, "start_s": 5.0, "s": 2.0, "rise": 1e-6}, "t_0", 105.0),
        ("elevation.centre_of_gravity", {"sign": 1.0, "droop": 0.0}, "delta", 0.06),
        ("elevation.weight_shift", {"sign": 1.0, "time_s": 5.0, "slide_s": 1e-3}, "t_1", 105.0),
        ("elevation.tail_coupling", {"sign": 1.0, "power": 2.0}, "k", 2e-8),
        ("azimuth.gyroscopic", {"cant_rad": 0.0}, "K", 3e-5),
        ("psi_sensor.scale", {"sign": 1.0, "bend": 0.0}, "scale", 1.04),
        ("psi_sensor.offset", {"sign": -1.0, "swing": 0.0}, "offset", -0.03),
    ],
)
def test_where_both_formulas_agree_the_equivalent_is_the_number_itself(
    visited: Visited, name: str, shape: Mapping[str, float], symbol: str, expected: float
) -> None:
    """Within 2 % (5 % for the sag of an exponential against a straight line)."""
    effect = next(effect for effect in CATALOGUE.known if effect.name == name)
    found = effect.equivalent(1.0, shape, visited)[symbol].value
    assert found == pytest.approx(expected, rel=0.05 if name.endswith("downwash") else 0.02)
