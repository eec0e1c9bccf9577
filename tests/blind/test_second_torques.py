"""Torques and rotors of the second rig under each effect against its formula in plain numbers."""

from collections.abc import Mapping

import numpy as np
import pytest

from blind.rigs.second.simulation import STEP_S
from tests.blind.second_rig import NOMINAL, Part

Settings = Mapping[tuple[str, int], float]
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
    ({("flutter", -1): 0.05, ("flutter_rad_s", -1): 360.0, ("flutter_width_rad_s", -1): 20.0},
     -0.05 * np.exp(-1) * L * F_M, 0.0),
    ({("flap", -1): 4e-3}, 0.0, 4e-3 * F_M * 0.5 * C),
    ({("downwash", -1): 0.1, ("downwash_power", -1): 1.5}, 0.0, L * F_T * C * (np.exp(-0.1 * (340 / 600) ** 1.5) - 1)),
    ({("chip", -1): 0.1, ("chip_time_s", -1): 3.9}, 0.0, -0.1 * L * F_T * C),
    ({("chip", -1): 0.1, ("chip_time_s", -1): 4.1}, 0.0, 0.0),
    ({("vortex", -1): 0.2, ("vortex_rad_s", -1): 0.6, ("vortex_width_rad_s", -1): 0.2},
     0.0, -0.2 * np.exp(-1) * L * F_T * C),
    ({("reverse", -1): -0.2, ("reverse_rad_s", -1): 20.0}, 0.0, 0.0),
    ({("drag", 0): 2e-3, ("drag_power", 0): 1.8}, -2e-3 * 0.5**1.8, 0.0),
    ({("drag", 1): 2e-3, ("drag_power", 1): 2.3}, 0.0, -2e-3 * 0.8**2.3),
    ({("spring", 0): 3e-3, ("spring_zero_rad", 0): 0.1, ("spring_slack", 0): 0.7, ("spring_growth", 0): 0.5},
     -3e-3 * 0.2 * 1.1, 0.0),
    ({("spring", 1): 3e-3, ("spring_zero_rad", 1): 0.1, ("spring_slack", 1): 0.7, ("spring_growth", 1): 0.5},
     0.0, 3e-3 * 0.7 * 0.5 * 1.25),
    ({("spin_inertia", 0): 4e-5, ("spin_soft_s", 0): 0.01}, -4e-5 * 250.0 / 0.01, 0.0),
    ({("spin_inertia", 1): 4e-5, ("spin_soft_s", 1): 0.01}, 0.0, -4e-5 * 340.0 / 0.01 * C),
    ({("pulse_Nm", 0): 4e-3, ("pulse_start_s", 0): 3.0, ("pulse_s", 0): 10.0, ("pulse_rise", 0): 0.2}, 2e-3, 0.0),
    ({("pulse_Nm", 1): 4e-3, ("pulse_start_s", 1): 1.0, ("pulse_s", 1): 10.0, ("pulse_rise", 1): 0.2}, 0.0, 4e-3),
    ({("pulse_Nm", 1): 4e-3, ("pulse_start_s", 1): 1.0, ("pulse_s", 1): 3.0, ("pulse_rise", 1): 0.2}, 0.0, 0.0),
    ({("drift_Nm_s", 0): 1e-4}, 4e-4, 0.0),
    ({("centre_rad", -1): 0.06, ("centre_droop", -1): 0.2}, TAU_G * (C - np.cos(0.3 + 0.06 * (1 + 0.2 * C))), 0.0),
    ({("weight", -1): 0.1, ("weight_time_s", -1): 3.5, ("weight_ramp_s", -1): 1.0}, -0.05 * TAU_G * C, 0.0),
    ({("weight", -1): 0.1, ("weight_time_s", -1): 2.0, ("weight_ramp_s", -1): 1.0}, -0.1 * TAU_G * C, 0.0),
    ({("tail_lift", -1): 2e-4, ("tail_lift_power", -1): 1.8}, 2e-4 * 2.5**1.8, 0.0),
    ({("tail_lift", -1): -2e-4, ("tail_lift_power", -1): 1.8}, -2e-4 * 2.5**1.8, 0.0),
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
    """Truth: spring of J s (1 - s) omega^2, equal and opposite; the sum of torques is the rigid arm's but for its
    bearing's drag."""
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


def test_knocks_come_one_in_each_stretch_of_time_and_last_sixty_milliseconds() -> None:
    for axis in (0, 1):
        settings = {("knock_Nm", axis): 6e-3, ("knock_every_s", axis): 1.0}
        part = Part(settings)
        kicks = np.array([part.at(t).outer_Nm[axis] for t in np.arange(0.0, 20.0, 0.005)])
        assert np.abs(kicks).max() == pytest.approx(6e-3, rel=0.02)
        assert np.mean(kicks != 0.0) == pytest.approx(0.06, abs=0.01)
        assert kicks.min() < 0.0 < kicks.max()
