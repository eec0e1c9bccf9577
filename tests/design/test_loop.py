"""Closed-loop poles: two ways to them, the coupled helicopter, sensitivity of equal poles, feed-forward as a hidden loop."""

import numpy as np
import pytest

from design.analysis.coupled import coupled_poles
from design.direct_form import DeltaForm
from design.discretise import SampledPlant, sample
from design.linearise import linearise
from design.loop import (
    closed_loop_poles,
    controller_poles,
    open_loop,
    plant_polynomials,
    polynomial_roots,
    slowest,
    to_rad_s,
)
from design.schedule import evaluate, schedule_of
from sim.equilibrium import equilibrium
from tests.design.helicopter import (
    AZ_DOM,
    DOM,
    DOM2,
    equal,
    helicopter,
    polynomials,
    sampled,
    settings_for,
    table_for,
    wide_angles,
)


def controller(axis, poles, free_degree, psi_rad):
    table = table_for(settings_for(**{axis: (poles, free_degree)}))
    return evaluate(schedule_of(table.axis(axis)), psi_rad)


def whole(psi_rad):
    return sample(linearise(helicopter(), equilibrium(helicopter(), psi_rad)), 0.01)


@pytest.mark.parametrize("axis", ["elevation", "azimuth"])
@pytest.mark.parametrize("psi_deg", [-40.0, 3.0, 40.0])
def test_polynomials_and_the_state_of_the_law_give_the_same_poles(axis, psi_deg):
    law = controller(axis, DOM2, "integral", np.radians(psi_deg))
    plant = sampled(axis, np.radians(psi_deg))
    by_polynomials = np.sort_complex(closed_loop_poles(open_loop(plant_polynomials(plant), law)))
    by_states = coupled_poles(plant, (law,))
    np.testing.assert_allclose(np.sort_complex(by_states[np.argsort(-by_states.real)[:6]]), by_polynomials, rtol=1e-6)


def test_plant_polynomials_are_those_of_the_resolvent():
    plant = sampled("elevation", 0.3)
    found = plant_polynomials(plant)
    for gamma in (0.1 + 0.2j, -0.3 + 0.05j):
        exact = (plant.C @ np.linalg.solve(gamma * np.eye(3) - plant.N, plant.B))[0, 0]
        assert np.polyval(found.b[::-1], gamma) / np.polyval(found.a[::-1], gamma) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize(
    ("elevation", "azimuth", "slowest_rad_s"),
    [
        ((equal(-8.0), "q3_zero"), (AZ_DOM, "q3_zero"), -1.24),
        ((DOM2, "integral"), (AZ_DOM, "q3_zero"), -1.48),
        ((DOM2, "integral"), (equal(-4.0), "q3_zero"), -1.65),
    ],
)
def test_both_loops_on_the_coupled_plant_have_the_published_slowest_pole(elevation, azimuth, slowest_rad_s):
    table = table_for(settings_for(elevation, azimuth))
    schedules = [schedule_of(law) for law in (table.axes[0], table.axes[1])]
    worst = max(
        slowest(coupled_poles(whole(psi), tuple(evaluate(schedule, psi) for schedule in schedules)))
        for psi in wide_angles()[::4]
    )
    assert worst == pytest.approx(slowest_rad_s, abs=6e-3)


def test_without_cross_coupling_the_coupled_poles_are_those_of_both_axes():
    laws = [controller(axis, DOM2, "integral", 0.2) for axis in ("elevation", "azimuth")]
    apart = [sampled(axis, 0.2) for axis in ("elevation", "azimuth")]
    N, B, C = np.zeros((6, 6)), np.zeros((6, 2)), np.zeros((2, 6))
    for index, plant in enumerate(apart):
        rows = slice(3 * index, 3 * index + 3)
        N[rows, rows], B[rows, index], C[index, rows] = plant.N, plant.B[:, 0], plant.C[0]
    found = coupled_poles(SampledPlant(N, B, C, 0.01), tuple(laws))
    wanted = np.concatenate(
        [closed_loop_poles(open_loop(plant_polynomials(p), law)) for p, law in zip(apart, laws, strict=True)]
    )
    np.testing.assert_allclose(np.sort(found.real)[-12:], np.sort(wanted.real), rtol=1e-5)


@pytest.mark.parametrize(
    ("poles", "free_degree", "slow_rad_s", "fast_rad_s"),
    [
        (DOM2, "integral", (-3.0, -2.96), (-3.03, -3.0)),
        (DOM, "integral", (-2.5, -2.48), (-2.53, -2.5)),
        (equal(-8.0), "integral", (-5.1, -4.7), (-6.7, -6.3)),
        (equal(-12.0), "integral", (-7.2, -6.8), (-9.4, -9.0)),
    ],
)
def test_the_fit_moves_equal_poles_a_lot_and_distinct_ones_hardly(poles, free_degree, slow_rad_s, fast_rad_s):
    found = [
        slowest(
            closed_loop_poles(
                open_loop(polynomials("elevation", psi), controller("elevation", poles, free_degree, psi))
            )
        )
        for psi in wide_angles()
    ]
    assert slow_rad_s[0] < max(found) < slow_rad_s[1]
    assert fast_rad_s[0] < min(found) < fast_rad_s[1]


@pytest.mark.parametrize(
    ("poles", "free_degree", "slowest_rad_s"),
    [
        (equal(-4.0), "q3_zero", 1.05),
        (equal(-6.0), "q3_zero", 0.43),
        (DOM, "q3_zero", 0.44),
        (DOM2, "q3_zero", 0.12),
        (DOM2, "integral", -1.45),
    ],
)
def test_feedforward_from_the_measured_elevation_moves_the_slowest_pole_as_published(poles, free_degree, slowest_rad_s):
    law = table_for(settings_for(elevation=(poles, free_degree))).axes[0]
    slope = np.polynomial.Polynomial(law.feedforward_V).deriv()

    def hidden_loop(psi):
        loop = open_loop(polynomials("elevation", psi), evaluate(schedule_of(law), psi))
        closed = np.convolve(loop.a, loop.p) + np.convolve(loop.b, loop.q - slope(psi) * loop.p)
        return slowest(to_rad_s(polynomial_roots(closed), 0.01))

    assert max(hidden_loop(psi) for psi in wide_angles()) == pytest.approx(slowest_rad_s, abs=0.02)


def test_a_pole_that_only_shifts_memory_counts_as_infinitely_fast():
    found = to_rad_s(np.array([-1.0 + 0.0j, -0.5 + 0.0j]), 0.01)
    assert found[0].real == -np.inf
    assert found[1] == pytest.approx(np.log(0.5) / 0.01)


def test_roots_at_zero_are_exact_as_an_integrator_must_be():
    assert 0.0 in polynomial_roots(np.array([0.0, 2.0, 3.0, 1.0]))
    integral = DeltaForm(q=np.ones(4), p=np.array([0.0, 0.9, 0.6]))
    assert 0.0 in controller_poles(integral)
