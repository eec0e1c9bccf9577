"""The recorded rigs' plants against motions that can be written down: rest points, swings, final speeds, delays, energy."""

import numpy as np
import pytest

from sim.bind import BoundPlant
from sim.simulate import Conditions, simulate
from tests.plants import bound


def states(
    plant: BoundPlant, t_s: np.ndarray, x0: list[float], u: list[float], locked: tuple[str, ...] = ()
) -> np.ndarray:
    run = simulate(plant, t_s, x0, np.tile(u, (t_s.size, 1)), Conditions(resolution=0.0, locked=locked))
    assert run.x is not None
    return run.x


def test_aeroshield_comes_to_rest_where_thrust_holds_the_weight() -> None:
    plant = bound("aeroshield")
    p = plant.parameter
    rest = np.arcsin(p("K") * 2.0 / (p("m") * p("g")))
    x = states(plant, np.arange(2000) * 0.01, [0.0, 0.0], [2.0])
    np.testing.assert_allclose(x[-1], [rest, 0.0], atol=1e-9)


def test_pamh_follows_its_transfer_function() -> None:
    # Step response of b / (s^2 + d s + k), exact; RK4 of 20 ms steps: 1e-4 rad.
    plant = bound("pamh_aeropendulum")
    b, d, k = (plant.parameter(name) for name in ("b", "d", "k"))
    t_s = np.arange(500) * 0.02
    w = np.sqrt(k - d**2 / 4)
    exact = b * 1.7 / k * (1 - np.exp(-d * t_s / 2) * (np.cos(w * t_s) + d / (2 * w) * np.sin(w * t_s)))
    np.testing.assert_allclose(states(plant, t_s, [0.0, 0.0], [1.7])[:, 0], exact, atol=1e-4)


def test_two_clocks_swings_with_the_period_of_a_pendulum() -> None:
    # Without damping, from rest at 1 rad: period 4 K(sin(1/2)) / sqrt(w2), K the complete elliptic integral, here 1.6749...
    plant = bound("aeroshield_two_clocks", d=0.0)
    theta = np.linspace(0.0, np.pi / 2, 20_001)
    integrand = 1.0 / np.sqrt(1.0 - np.sin(0.5) ** 2 * np.sin(theta) ** 2)
    period_s = 4.0 * float(np.trapezoid(integrand, theta)) / np.sqrt(plant.parameter("w2"))
    x = states(plant, np.array([0.0, *np.linspace(0.0, 3.0 * period_s, 1501)[1:]]), [1.0, 0.0], [0.0])
    np.testing.assert_allclose(x[[500, 1000, 1500], 0], 1.0, atol=1e-6)


def test_emps_reaches_the_speed_at_which_friction_takes_all_force() -> None:
    plant = bound("emps", F_c=20.39, offset=-3.16)
    p = plant.parameter
    final = (p("gtau") * 3.0 - p("F_c") - p("offset")) / p("F_v")
    x = states(plant, np.arange(8000) * 0.001, [0.0, 0.0], [3.0])
    assert x[-1, 1] == pytest.approx(final, rel=1e-6)


def test_emps_stays_where_dry_friction_holds_it() -> None:
    plant = bound("emps", F_c=20.39, offset=-3.16)
    held = 0.9 * (20.39 - 3.16) / plant.parameter("gtau")
    x = states(plant, np.arange(500) * 0.001, [0.1, 0.0], [held])
    np.testing.assert_array_equal(x, np.tile([0.1, 0.0], (500, 1)))


def test_a_coil_s_current_rises_with_its_time_constant() -> None:
    # Full duty, from no current: i = k/R (1 - exp(-t R/L)), 2.7957 A in the end and 1 - 1/e of that after L/R = 24 ms.
    t_s = np.arange(600) * 1e-3
    current_A = states(bound("maglev_coil", R=4.17, L=0.1), t_s, [0.0], [1.0])[:, 0]
    np.testing.assert_allclose(current_A, 11.658 / 4.17 * (1.0 - np.exp(-t_s * 41.7)), atol=1e-6)
    assert current_A[-1] == pytest.approx(2.7957, abs=1e-4)


def test_a_driven_pendulum_comes_to_rest_where_its_torque_holds_the_weight() -> None:
    # G sin(theta) = tau: 0.9 N m hold it at asin(0.9 / 3.31) = 0.27537 rad.
    x = states(bound("torque_limited_pendulum", b=0.5), np.arange(5000) * 5e-3, [0.0, 0.0], [0.9])
    np.testing.assert_allclose(x[-1], [0.27537, 0.0], atol=1e-5)


def test_a_driven_pendulum_starts_as_its_inertia_lets_it() -> None:
    # From where it hangs, 0.9 N m on 0.169 kg m^2 are 5.3254 rad/s^2; 0.2 N m of dry friction leave 4.1420 rad/s^2.
    t_s = np.array([0.0, 1e-4])
    for friction_Nm, expected in ((0.0, 5.3254), (0.2, 4.1420)):
        x = states(bound("torque_limited_pendulum", tau_c=friction_Nm), t_s, [0.0, 0.0], [0.9])
        assert x[-1, 1] / 1e-4 == pytest.approx(expected, rel=1e-3)


def test_antx_answers_a_step_of_torque_late_by_its_delay() -> None:
    # The exact answer of eq (1) to a step at t = 0 is that of the undelayed mode, shifted by tau; the approximation of the delay
    # is good to 0.1 % of the swing once the delay has passed.
    plant = bound("antx_2dof_drone")
    wn, xi, mu, tau = (plant.parameter(name) for name in ("omega_n", "xi", "mu", "tau"))
    t_s = np.arange(1000) * 0.004
    late = np.maximum(t_s - tau, 0.0)
    w = wn * np.sqrt(1 - xi**2)
    damped = np.exp(-xi * wn * late) * (np.cos(w * late) + xi * wn / w * np.sin(w * late))
    exact = mu * 0.01 / wn**2 * (1 - damped)
    x = states(plant, t_s, [0.0, 0.0, 0.0, 0.0], [0.01])
    after = t_s > 2 * tau
    assert np.abs(x[after, 0] - exact[after]).max() < 1e-3 * exact.max()
    assert np.abs(x[~after, 0] - exact[~after]).max() < 2e-4 * exact.max()


def test_quanser_pitches_to_the_published_equilibrium() -> None:
    # sin(theta) = 6.364e-6 w^2, the published fit of the main rotor's pitch equilibria, w = 17.38 V; yaw locked. 1 % by rounding.
    x = states(bound("quanser_aero"), np.arange(60_000) * 0.002, [0.0] * 4, [10.0, 0.0], locked=("yaw",))
    assert np.sin(x[-1, 0]) == pytest.approx(6.364e-6 * 173.8**2, rel=0.01)
    np.testing.assert_array_equal(x[:, 2:], 0.0)


def test_quanser_body_inertia_is_the_published_number() -> None:
    # A locked pitch at 0 and a coasting yaw: psi' decays with d2 / (Iy + Ib), Ib = 0.0183654, Iy = 1.052e-4 kg m^2.
    x = states(bound("quanser_aero"), np.arange(1001) * 0.002, [0.0, 0.0, 0.0, 1.0], [0.0, 0.0], locked=("pitch",))
    assert x[-1, 3] == pytest.approx(np.exp(-0.0075 * 2.0 / (0.0183654 + 1.052e-4)), rel=1e-5)


def test_quanser_coasting_without_friction_keeps_its_spin_and_energy() -> None:
    # (Iy + Ib cos^2 theta) psi' is constant, and so is kinetic plus potential energy: eqs (1) and (2) come from one Lagrangian.
    plant = bound("quanser_aero", d1=0.0, d2=0.0)
    p = plant.parameter
    Ib, Iy = (
        2 * (p("mpa") + p("me")) * p("dt") ** 2 + p("me") * p("dx") ** 2 + p("mrod") * p("lt") ** 2 / 12,
        0.526 * 0.02**2 / 2,
    )
    theta, theta_dot, _, psi_dot = states(plant, np.arange(5000) * 0.002, [0.7, 0.0, 0.0, 2.0], [0.0, 0.0]).T
    inertia = Iy + Ib * np.cos(theta) ** 2
    energy = (Ib * theta_dot**2 + inertia * psi_dot**2) / 2 - p("dx") * p("g") * p("me") * np.cos(theta)
    np.testing.assert_allclose(inertia * psi_dot, inertia[0] * psi_dot[0], rtol=1e-8)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
