"""Eq (26) with each choice of its free degree, and the choices that only work on paper."""

import numpy as np
import pytest

from design.analysis.margins import margins
from design.direct_form import DirectForm, controller_poles_z, to_delta, to_direct
from design.discretise import sample
from design.linear_plant import LinearPlant
from design.linearise import linearise, subsystem
from design.loop import closed_loop_poles, open_loop, plant_polynomials, slowest
from design.pole_placement import (
    FREE_DEGREES,
    FreeDegree,
    characteristic,
    demand_usable,
    placed_in_gamma,
    poles_z,
    refined,
    sylvester,
)
from design.schedule import evaluate, schedule_of
from design.transfer import transfer_function
from records.errors import BadInput
from records.loops import LOOPS
from records.table import AXES
from sim.equilibrium import equilibrium
from tests.design.helicopter import (
    AZ_DOM,
    DOM,
    DOM2,
    SAMPLE_PERIOD_S,
    equal,
    helicopter,
    place,
    polynomials,
    settings_for,
    table_for,
    wide_angles,
)

EQ8 = equal(-8.0)


def transfer(axis="elevation", psi_deg=0.0):
    linear = linearise(helicopter(), equilibrium(helicopter(), np.radians(psi_deg)))
    return transfer_function(subsystem(helicopter(), linear, LOOPS[AXES.index(axis)]), SAMPLE_PERIOD_S, axis)


def wanted(poles):
    return characteristic(poles_z(poles, SAMPLE_PERIOD_S))


def placed(free, poles=EQ8, axis="elevation", psi_deg=0.0):
    found = transfer(axis, psi_deg)
    return place(found.b, found.a, wanted(poles), free, f"{axis} at {psi_deg:g} deg")


@pytest.mark.parametrize(
    ("name", "largest_q", "controller_pole", "sensitivity", "phase_margin_deg"),
    [
        ("integral", 619.0, 1.0, 1.97, 32.0),
        ("q3_zero", 15.4, 0.909, 1.80, 42.0),
        ("q0_zero", 15.6, 0.913, 1.85, 41.0),
        ("q_nyquist_zero", 4.05, 0.911, 1.82, 41.0),
    ],
)
def test_free_degree_gives_the_published_gain_and_margins(
    name, largest_q, controller_pole, sensitivity, phase_margin_deg
):
    controller = placed(FREE_DEGREES[name]).controller
    found = margins(open_loop(polynomials("elevation", 0.0), to_delta(controller)))
    assert np.max(np.abs(controller.q)) == pytest.approx(largest_q, rel=5e-3)
    assert np.max(np.abs(controller_poles_z(controller))) == pytest.approx(controller_pole, abs=6e-4)
    assert found.sensitivity == pytest.approx(sensitivity, abs=6e-3)
    assert np.degrees(found.phase_rad) == pytest.approx(phase_margin_deg, abs=0.6)


@pytest.mark.parametrize("poles", [DOM, DOM2, AZ_DOM, equal(-12.0), (*DOM2, -25.0)])
@pytest.mark.parametrize("name", FREE_DEGREES)
@pytest.mark.parametrize(("axis", "psi_deg"), [("elevation", -40.0), ("elevation", 40.0), ("azimuth", 20.0)])
def test_closed_loop_has_the_wanted_polynomial_and_the_condition_holds(axis, psi_deg, poles, name):
    found, free = transfer(axis, psi_deg), FREE_DEGREES[name]
    placement = place(found.b, found.a, wanted(poles), free, axis)
    controller = placement.controller
    fed_back = np.convolve(found.a, controller.p)
    closed = fed_back + np.resize(np.append(np.convolve(found.b, controller.q), 0.0), len(fed_back))
    unknowns = np.append(controller.p[1:], controller.q)
    np.testing.assert_allclose(closed, wanted(poles), atol=1e-12)
    assert abs(np.dot(free.row(len(controller.p) - 1, len(controller.q)), unknowns) - free.value) < 1e-12 * np.max(
        np.abs(unknowns)
    )
    assert placement.condition < 200.0


def test_distinct_poles_come_out_to_six_digits():
    controller = to_delta(placed(FREE_DEGREES["integral"], DOM2).controller)
    poles = closed_loop_poles(open_loop(polynomials("elevation", 0.0), controller))
    np.testing.assert_allclose(sorted(poles.real), sorted(DOM2), rtol=1e-6)


def test_scaling_takes_the_condition_number_from_a_million_to_about_fifty():
    found = transfer()
    raw = np.vstack([sylvester(found.b, found.a, 3), FREE_DEGREES["integral"].row(3, 4)])
    assert 1e6 < np.linalg.cond(raw) < 1e7
    assert 40.0 < placed(FREE_DEGREES["integral"]).condition < 65.0


def test_least_norm_places_the_poles_on_paper_only_and_is_refused():
    found = transfer()
    scale = np.max(np.abs(found.b))
    null = np.linalg.svd(sylvester(found.b / scale, found.a, 3))[2][-1] * np.array([1.0] * 3 + [scale] * 4)
    with pytest.raises(BadInput, match=r"elevation at 0 deg.*pole of its own with \|z\| = 1\.406") as caught:
        placed(FreeDegree(lambda n: null[:n], lambda _: null[3:], 0.0, "least norm"))
    assert "free_degree" in caught.value.remedy


def test_p3_zero_is_refused_as_the_controller_is_unstable():
    with pytest.raises(BadInput, match=r"pole of its own with \|z\| = 2\.2[34]"):
        placed(FreeDegree(lambda n: [0.0, 0.0, 1.0, 0.0][:n], lambda n: [0.0] * n, 0.0, "p_3 = 0"))


def test_a_plant_whose_polynomials_share_a_root_is_refused_as_ill_conditioned():
    shared = np.array([1.0, -0.9])
    a, b = np.convolve(shared, [1.0, -1.8, 0.81]), np.append(0.0, np.convolve(shared, [1.0, 0.2]))
    with pytest.raises(BadInput, match=r"azimuth at 5 deg.*condition number"):
        place(b, a, wanted(EQ8), FREE_DEGREES["q3_zero"], "azimuth at 5 deg")


def test_a_plant_of_five_states_slow_beside_its_samples_is_placed_in_gamma():
    """Truth: three inertias on two springs, 2 ms; eq (26) in z^-1 is refused there, and the poles asked for come out to 1e-3 rad/s."""
    inertia, spring, friction = np.array([2.4e-3, 1.9e-3, 1.9e-3]), 2.8, 7e-3
    A, B, C = np.zeros((5, 5)), np.zeros((5, 1)), np.eye(1, 5)  # speeds, then twists
    A[:3, :3] = -friction * np.diag(1.0 / inertia)
    A[:3, 3:] = spring * np.array([[-1.0, 0.0], [1.0, -1.0], [0.0, 1.0]]) / inertia[:, np.newaxis]
    A[3:, :3] = [[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]]
    B[0] = 1.0 / inertia[0]
    linear, free = LinearPlant(A, B, C), FREE_DEGREES["integral"]
    asked = np.array([-6, -7, *(a + s * 1j * w for a, w in ((-5, 20), (-3, 62), (-4, 25), (-4, 61)) for s in (1, -1))])
    found, plant = transfer_function(linear, 0.002, "motor"), plant_polynomials(sample(linear, 0.002))
    with pytest.raises(BadInput, match="condition number"):
        place(found.b, found.a, characteristic(poles_z(asked, 0.002)), free, "motor")
    placement = placed_in_gamma(plant, asked, free)
    demand_usable(placement, "motor")
    exact = refined(plant, to_delta(placement.controller), asked, free)
    poles = closed_loop_poles(open_loop(plant, exact))
    assert max(np.min(abs(poles - pole)) for pole in asked) < 1e-3


def closed_loop_slowest(q, p, psi_deg=0.0):
    return slowest(
        closed_loop_poles(open_loop(polynomials("elevation", np.radians(psi_deg)), to_delta(DirectForm(q, p))))
    )


@pytest.mark.parametrize(("free_degree", "poles"), [("q3_zero", EQ8), ("integral", DOM2)])
def test_eq_26_solved_in_float32_as_on_a_microcontroller_is_unstable_at_many_angles(free_degree, poles):
    unstable = 0
    for psi_deg in np.linspace(-40.0, 40.0, 9):
        found, free = transfer("elevation", psi_deg), FREE_DEGREES[free_degree]
        scale = np.max(np.abs(found.b))
        unscale = np.array([1.0] * 3 + [1.0 / scale] * 4)
        row = free.row(3, 4) * unscale
        system = np.vstack([sylvester(found.b / scale, found.a, 3), row / np.max(np.abs(row))]).astype(np.float32)
        target = np.append(wanted(poles)[1:] - np.append(found.a[1:], np.zeros(3)), free.value / np.max(np.abs(row)))
        solution = np.linalg.solve(system, target.astype(np.float32)).astype(float) * unscale
        unstable += closed_loop_slowest(solution[3:], np.append(1.0, solution[:3]), psi_deg) > 0.0
    assert unstable >= 3


@pytest.mark.parametrize(("decimals", "slowest_rad_s"), [(3, -2.5), (2, 0.08)])
def test_direct_form_rounded_to_decimals_has_the_published_slowest_pole(decimals, slowest_rad_s):
    schedule = schedule_of(table_for(settings_for((EQ8, "q3_zero"))).axes[0])
    found = []
    for psi_rad in wide_angles():
        form = to_direct(evaluate(schedule, psi_rad))
        found.append(closed_loop_slowest(np.round(form.q, decimals), form.p, np.degrees(psi_rad)))
    assert max(found) == pytest.approx(slowest_rad_s, abs=0.02)
