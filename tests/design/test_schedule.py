"""Fits over the operating points: published errors, sums that stay exact, zeros that are zeros."""

import numpy as np
import pytest

from design.direct_form import to_direct
from design.operating_points import design_points
from design.schedule import Degrees, fit, fit_error, fit_schedule, schedule_of
from design.table import observer
from records.table import AXES, SHORT_BITS
from tests.design.helicopter import AZ_DOM, DOM2, base_settings, equal, helicopter, settings_for, table_for


def designs(axis, poles, free_degree):
    points = design_points(helicopter(), settings_for(**{axis: (poles, free_degree)}))
    return points.psi_rad, [design.delta for design in points.axes[AXES.index(axis)]]


@pytest.mark.parametrize(
    ("axis", "poles", "free_degree", "largest_q_error", "largest_p_error"),
    [
        ("elevation", equal(-8.0), "q3_zero", (6.5e-3, 7.1e-3), 2.8e-5),
        ("elevation", DOM2, "integral", (6.5e-3, 7.1e-3), 2.8e-5),
        ("azimuth", AZ_DOM, "q3_zero", (0.3e-3, 4.7e-3), 2.1e-4),
        ("azimuth", equal(-4.0), "q3_zero", (0.3e-3, 4.7e-3), 2.1e-4),
        ("azimuth", equal(-2.0), "q3_zero", (1.7e-2, 1.9e-2), 2.1e-4),
    ],
)
def test_cubic_fit_has_the_published_error(axis, poles, free_degree, largest_q_error, largest_p_error):
    psi_rad, deltas = designs(axis, poles, free_degree)
    error = fit_error(psi_rad, deltas, fit_schedule(psi_rad, deltas, Degrees(3, 3), 0.01))
    assert largest_q_error[0] < error.direct_q < largest_q_error[1]
    assert error.direct_p < largest_p_error


@pytest.mark.parametrize(("degree", "lowest", "highest"), [(1, 0.10, 0.16), (2, 0.007, 0.011), (4, 3e-4, 5e-4)])
def test_error_falls_with_the_degree_as_published(degree, lowest, highest):
    psi_rad, deltas = designs("elevation", DOM2, "integral")
    assert (
        lowest
        < fit_error(psi_rad, deltas, fit_schedule(psi_rad, deltas, Degrees(degree, degree), 0.01)).direct_q
        < highest
    )


def test_sums_of_fits_are_fits_of_sums_although_single_coefficients_are_off_by_far_more():
    psi_rad, deltas = designs("elevation", DOM2, "integral")
    direct_q = np.array([to_direct(delta).q for delta in deltas])
    fits = np.array([fit(psi_rad, column, 3) for column in direct_q.T])
    misses = np.polynomial.polynomial.polyval(psi_rad, fits.T) - direct_q.T
    gain_at_rest = np.sum(direct_q, axis=1)
    assert np.max(np.abs(misses)) > 100.0 * np.max(gain_at_rest)
    np.testing.assert_allclose(np.sum(fits, axis=0), fit(psi_rad, gain_at_rest, 3), atol=1e-9)


def test_integral_action_and_the_missing_q3_are_exactly_zero_at_every_angle():
    integral = schedule_of(table_for(settings_for()).axes[0])
    without = schedule_of(table_for(settings_for(elevation=(equal(-8.0), "q3_zero"))).axes[0])
    assert integral.p[0] == (0.0,) * 4
    assert without.q[3] == (0.0,) * 4
    assert without.p[0][0] != 0.0


def test_azimuth_does_not_know_up_from_down_and_its_polynomials_are_even():
    law = table_for(settings_for()).axes[1]
    for row in (*law.q_V_rad, *law.p, law.feedforward_V):
        assert row[1::2] == (0.0,) * len(row[1::2])


def test_feedforward_misses_the_equilibrium_by_the_published_millivolts():
    table, points = table_for(settings_for()), design_points(helicopter(), base_settings())
    voltages = np.array([point.u0 for point in points.equilibria])
    for column, (law, error_mV) in enumerate(((table.axes[0], 2.9), (table.axes[1], 1.8))):
        fitted = np.polynomial.polynomial.polyval(points.psi_rad, law.feedforward_V)
        assert 1e3 * np.max(np.abs(fitted - voltages[:, column])) == pytest.approx(error_mV, abs=0.06)


def test_fit_reproduces_a_polynomial_of_its_degree_and_drops_rounding():
    psi_rad = np.linspace(-0.7, 0.7, 17)
    found = fit(psi_rad, 3.0 - 2.0 * psi_rad**2, 3)
    np.testing.assert_allclose(found, [3.0, 0.0, -2.0, 0.0], rtol=1e-12)
    assert found[1] == found[3] == 0.0


@pytest.mark.parametrize("pole", [0.0, 0.5, 0.9])
def test_observer_is_a_triple_pole(pole):
    a_0, a_1, a_2 = observer(pole, 3)
    for z in (0.3 + 0.4j, -0.8 + 0.1j, 1.0 + 0.0j):
        delta = 1.0 - 1.0 / z
        found = 1.0 - (1.0 - a_0 + a_1 * delta + a_2 * delta**2) / z
        rounding = 2.0**-SHORT_BITS * (a_0 + a_1 * abs(delta) + a_2 * abs(delta) ** 2) / abs(z)
        assert abs(found - (1.0 - pole / z) ** 3) <= 1e-14 + rounding / 2.0
