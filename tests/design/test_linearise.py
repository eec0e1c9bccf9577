"""The linear plant: published eigenvalues of the body, and what friction and coupling leave in it."""

import numpy as np
import pytest

from design.linear_plant import LinearPlant
from design.linearise import linearise, of_loops, subsystem
from records.loops import LOOPS, Loop
from records.plant import load_plant
from sim.bind import bind
from sim.equilibrium import OperatingPoint, equilibrium
from tests.design.helicopter import helicopter
from tests.own_plants import RATE_ONLY, TWO_HEATERS


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


def test_what_another_loop_measures_is_held_where_nothing_moves(tmp_path):
    """Truth by hand: of two heated bodies with heat flowing between them, each loop sees its own: T1' = -(G + H)/C T1 + heat/C."""
    plant = TWO_HEATERS.write(tmp_path, "two_heaters")
    bound = bind(load_plant(plant))
    loops = (Loop("left", "T1_K", "heat1_W", "left"), Loop("right", "T2_K", "heat2_W", "right"))
    whole = linearise(bound, OperatingPoint(0.0, np.zeros(2), np.zeros(2)))
    for loop in loops:
        own = subsystem(bound, whole, loop, loops)
        np.testing.assert_allclose(own.A, np.array([[-0.5 / 30.0]]))
        np.testing.assert_allclose(own.B, np.array([[1.0 / 30.0]]))
    assert len(subsystem(bound, whole, loops[0], loops[:1]).A) == 2


@pytest.mark.parametrize(("hidden_1_s", "states"), [(0.0, 1), (-1.0, 1), (1.0, 2)])
def test_what_no_output_shows_counts_only_where_it_grows(hidden_1_s, states, tmp_path):
    # Truth: theta' = omega + hidden theta beside omega' = -2 omega + 5 u, of which omega alone is measured, does not act on omega.
    bound = bind(load_plant(RATE_ONLY.write(tmp_path, "rate_only")))
    whole = LinearPlant(np.array([[hidden_1_s, 1.0], [0.0, -2.0]]), np.array([[0.0], [5.0]]), np.array([[0.0, 1.0]]))
    found = of_loops(bound, whole, (Loop("wheel", "omega_rad_s", "u_V", "omega"),))
    assert found.A.shape == (states, states)
    assert found.A[-1, -1] == -2.0
    assert found.B[-1, 0] == 5.0
    assert found.C[0, -1] == 1.0
