"""The CE150 on the bench: the figures of facts/ce150.md B1, compared in the digits in which they are stated there."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from sim.equilibrium import equilibrium
from sim.manoeuvres import at_rest
from sim.simulate import simulate

MU_V = 10.0
NOWHERE = [0.0, 0.0]


def elevation_deg(bound, u_M_MU, seconds):
    """Elevation in deg at 100 Hz, from rest on the lower stop, the azimuth locked as on the bench."""
    t = np.arange(round(seconds * 100) + 1) * 0.01
    u = np.column_stack([MU_V * np.broadcast_to(u_M_MU(t), t.shape), np.zeros(t.size)])
    runs = simulate(bound, t, at_rest(bound), u, locked=("azimuth",), resolution=NOWHERE)
    return t, np.degrees(runs.x[:, 1]), runs.u[:, 0] / MU_V


@pytest.fixture(scope="module")
def creeping(bound):
    """The plant with the smooth friction of the source's figures, b_c tanh(v / 0.005 rad/s): it creeps to rest, ours sticks."""
    elevation, azimuth = bound.model.axes
    smooth = replace(
        elevation,
        torque=elevation.torque - elevation.coulomb * sympy.tanh(elevation.velocity / 0.005),
        coulomb=sympy.Integer(0),
    )
    return replace(bound, model=replace(bound.model, axes=(smooth, azimuth)))


def test_a_slow_ramp_moves_at_0_465_MU_and_flies_to_the_upper_stop_at_0_570_MU(bound):
    _, psi_deg, u_MU = elevation_deg(bound, lambda t: 0.44 + 0.002 * t, 70.0)
    first = u_MU[np.argmax(psi_deg > -45.0)]
    assert first > 0.465
    assert first == pytest.approx(0.467, abs=2e-3)
    assert u_MU[np.argmax(psi_deg >= 45.0)] == pytest.approx(0.570, abs=1e-3)
    assert psi_deg[-1] == 45.0


@pytest.mark.parametrize(("psi_deg", "u_MU"), [(-41.99, 0.48), (-36.7, 0.50), (-26.7, 0.53), (-8.6, 0.56)])
def test_the_static_map_without_friction(bound, psi_deg, u_MU):
    """Rest points as published; those of a rig with friction lie within the band that friction holds."""
    assert equilibrium(bound, np.radians(psi_deg)).u0[0] / MU_V == pytest.approx(u_MU, abs=4e-3)


def test_a_step_of_0_53_MU_swings_and_settles_as_published(creeping):
    t, psi_deg, _ = elevation_deg(creeping, lambda t: 0.53, 20.0)
    peaks = [k for k in range(1, t.size - 1) if psi_deg[k - 1] < psi_deg[k] >= psi_deg[k + 1]]
    assert psi_deg[peaks[0]] == pytest.approx(-11.0, abs=0.5)
    assert t[peaks[1]] - t[peaks[0]] == pytest.approx(3.0, abs=0.35)
    assert psi_deg[t > 8.0].mean() == pytest.approx(-25.8, abs=0.1)
    assert np.all(np.abs(psi_deg[t > 8.0] + 25.8) < 1.0)


def test_true_friction_holds_the_arm_within_its_band_of_the_rest_point(bound):
    """It sticks where |gravity - thrust| <= b_cE: b_cE / (tau_gE sin 25.9 deg) = 0.7 deg about -25.9 deg."""
    _, psi_deg, _ = elevation_deg(bound, lambda t: 0.53, 20.0)
    band_deg = np.degrees(2e-4 / (0.0383 * np.sin(np.radians(25.9))))
    assert abs(psi_deg[-1] + 25.9) < band_deg
    assert psi_deg[-1] == psi_deg[-200]


def test_the_azimuth_balances_at_0_360_MU_for_a_tail_input_of_0_15_MU(bound):
    """l_T F_T = K_A omega_M on the equations alone, at the rotors' steady speeds."""
    t = np.arange(801) * 0.01
    u = np.broadcast_to([3.60, 1.5], (t.size, 2)).copy()
    x = simulate(bound, t, at_rest(bound), u, locked=("elevation", "azimuth"), resolution=NOWHERE).x[-1]
    names = dict(zip(map(str, bound.model.parameter_symbols), bound.p, strict=True))
    thrust = sum(names[f"p_FT_{power}"] * x[3] ** power for power in range(5))
    assert names["l_T"] * thrust == pytest.approx(names["K_A"] * x[0], rel=5e-3)
