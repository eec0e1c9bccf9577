"""Drivers, bearings and encoders of the second rig under each effect against its formula in plain numbers."""

from collections.abc import Mapping

import numpy as np
import pytest

from blind.rigs.second.catalogue import CATALOGUE
from blind.rigs.second.simulation import PRESLIDING, ROUNDED, STEP_S, STICK_SLIP, bearing
from tests.blind.second_rig import NOMINAL, Part

Settings = Mapping[tuple[str, int], float]
J_E, J_A = NOMINAL.value("J_E"), NOMINAL.value("J_A")
# psi psi' phi phi' omega_M omega_T
X = [0.3, 0.5, -0.4, 0.8, 340.0, 250.0]
C = np.cos(0.3)


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
    part = Part(effect.settings(2.0, {"delay_spread": 0.2}))
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
        after = part.rub(bearing(law, width, width))[1 + 2 * axis]
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
    """Truth: 5 mrad behind on the way up, 5 mrad ahead on the way down, for a width of 10 mrad; nothing moves for the
    lesser play."""
    shown = Part({("backlash_rad", axis): 0.01, ("backlash_split", axis): 0.3}).shown(PATH, axis)
    assert (PATH - shown)[3999] == pytest.approx(5e-3, abs=1e-6)
    assert (shown - PATH)[-1] == pytest.approx(5e-3, abs=1e-6)
    assert np.sum(np.diff(shown[3999:]) == 0.0) == pytest.approx(0.007 / 1e-4, abs=2)


def test_lines_that_pass_too_fast_are_missed() -> None:
    """Truth: 0.1 of what goes beyond 0.3 rad/s, for half a second at 0.8 rad/s."""
    shown = Part({("missed", 1): 0.1, ("missed_rad_s", 1): 0.3}).shown(PATH[:4000], 1)
    assert (PATH[3999] - shown[-1]) == pytest.approx(0.1 * 0.5 * 0.5, abs=1e-4)


def test_a_coarse_encoder_gives_multiples_of_its_step_and_holds_them_beyond_the_edge() -> None:
    """Through the stated steps of 2 pi / 4096: never further from a multiple than half of one; up and down differ by 2
    holds."""
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
