"""Seed 001's model against figures worked out from its numbers by hand, and against its equations in the paper's own variables."""

import numpy as np
import pytest

from identification.experiments.velagic.rig import PERIOD_S, PHI, PSI, UPRIGHT, VelagicRig
from sim.equilibrium import equilibrium
from sim.simulate import Conditions, simulate
from tests.plants import bound

HOVER_MU = {-45.0: 0.4422, -30.0: 0.5076, -20.0: 0.5361, -10.0: 0.5530, 0.0: 0.5587}  # a_1 u^2 + b_1 u = tau_G cos(Psi)


@pytest.mark.parametrize("angle_deg", list(HOVER_MU))
def test_it_hovers_at_the_voltages_of_its_own_square_law(angle_deg: float) -> None:
    point = equilibrium(bound("ce150_velagic"), np.radians(angle_deg))
    assert point.u0[0] / 10.0 == pytest.approx(HOVER_MU[angle_deg], abs=1e-4)


def test_at_048_mu_the_tail_motor_must_give_038_mu() -> None:
    """Not the 0.15 to 0.25 MU of the paper's own Figs. 13 and 18: its set does not reproduce them."""
    plant = bound("ce150_velagic")
    u_2 = VelagicRig(plant).balance_MU(0.48)
    assert u_2 == pytest.approx(0.38, abs=0.005)
    x0 = np.array([288.0, 288.0, -np.pi / 5, 0.0, 800.0 * u_2, 800.0 * u_2, 0.3, 0.0])
    run = simulate(plant, np.arange(100) * 0.02, x0, np.tile([4.8, 10.0 * u_2], (100, 1)), Conditions(resolution=0.0))
    assert run.y is not None
    np.testing.assert_allclose(run.y[:, 1], 0.3, atol=1e-9)


@pytest.mark.parametrize("locked", [False, True])
def test_it_moves_as_the_paper_s_equations_in_the_paper_s_variables(locked: bool) -> None:
    """A minute of steps of both voltages, the lower stop hit: apart by less than 0.02 deg, and most of that from the rig's stop."""
    plant, rng = bound("ce150_velagic"), np.random.default_rng(1)
    rig = VelagicRig(plant, azimuth_locked=locked)
    u = np.repeat(np.column_stack([rng.uniform(0.43, 0.52, 30), rng.uniform(0.3, 0.45, 30)]), 200, axis=0)
    states = np.array(rig.run(rig.rest(), u))[:-1]
    x0 = np.zeros(8)
    x0[2] = -np.pi / 4
    run = simulate(
        plant,
        np.arange(6000) * PERIOD_S,
        x0,
        10.0 * u,
        Conditions(resolution=0.0, locked=("azimuth",) if locked else ()),
    )
    assert run.y is not None
    assert np.ptp(run.y[:, 0]) > 0.2
    assert locked or np.ptp(run.y[:, 1]) > 2.0
    np.testing.assert_allclose(run.y[:, 0], states[:, PSI] - UPRIGHT, atol=np.radians(0.02))
    np.testing.assert_allclose(run.y[:, 1], states[:, PHI], atol=np.radians(0.02))


def test_motion_tells_ratios_of_torques_alone() -> None:
    """All torques of the elevation times 1.3 with an inertia as much larger, those of the azimuth times 0.7: the same flight."""
    scaled = dict.fromkeys(("a_1", "b_1", "B_psi", "tau_G", "k_G"), 1.3) | {"I_inv": 1.0 / 1.3}
    scaled |= dict.fromkeys(("a_2", "b_2", "a_3", "b_3", "B_phi"), 0.7) | {"Ic_inv": 1.0 / 0.7}
    one = bound("ce150_velagic")
    other = bound("ce150_velagic", **{name: factor * one.parameter(name) for name, factor in scaled.items()})
    u = np.repeat(np.random.default_rng(2).uniform([4.6, 3.5], [5.4, 4.5], (10, 2)), 100, axis=0)
    x0 = np.array([0.0, 0.0, -np.pi / 4, 0.0, 0.0, 0.0, 0.0, 0.0])
    flights = [simulate(plant, np.arange(1000) * 0.02, x0, u, Conditions(resolution=0.0)).y for plant in (one, other)]
    assert flights[0] is not None
    assert np.ptp(flights[0][:, 0]) > 0.2
    np.testing.assert_allclose(flights[1], flights[0], atol=1e-9)


def test_the_text_s_form_of_eq_7_would_hover_at_half_the_voltage_of_the_figure() -> None:
    plant = bound("ce150_velagic")
    literal_MU = np.sqrt((plant.parameter("tau_G") - plant.parameter("b_1")) / plant.parameter("a_1"))
    assert literal_MU == pytest.approx(0.278, abs=1e-3)
