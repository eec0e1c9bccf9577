"""The linear plant: published eigenvalues of the body, and what friction and coupling leave in it."""

import numpy as np
import pytest

from design.linearise import linearise, subsystem
from records.loops import LOOPS
from sim.equilibrium import equilibrium
from tests.design.helicopter import helicopter


def linear(psi_deg):
    return linearise(helicopter(), equilibrium(helicopter(), np.radians(psi_deg)))


@pytest.mark.parametrize(
    ("psi_deg", "eigenvalues"),
    [(-40.0, (-0.211 + 2.364j, -0.211 - 2.364j)), (0.0, (0.0, -0.421)), (20.0, (1.534,)), (40.0, (2.172,))],
)
def test_body_has_the_published_eigenvalues_beside_the_rotor(psi_deg, eigenvalues):
    found = np.linalg.eigvals(subsystem(helicopter(), linear(psi_deg), LOOPS[0]).A)
    for wanted in eigenvalues:
        assert np.min(np.abs(found - wanted)) < 1e-3
    assert -7.4 < np.min(found.real) < -6.5


def test_azimuth_acceleration_does_not_depend_on_the_elevation_at_rest_as_friction_is_left_out():
    names = [symbol.name for symbol in helicopter().model.states]
    row, column = names.index("phi_dot_rad_s"), names.index("psi_rad")
    assert abs(linear(30.0).A[row, column]) < 1e-12


@pytest.mark.parametrize("psi_deg", [-40.0, 40.0])
def test_azimuth_rate_acts_on_the_elevation_as_published(psi_deg):
    names = [symbol.name for symbol in helicopter().model.states]
    found = linear(psi_deg).A[names.index("psi_dot_rad_s"), names.index("phi_dot_rad_s")]
    assert abs(found) == pytest.approx(1.12, abs=6e-3)
