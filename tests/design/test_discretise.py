"""Sampling: the published numbers, an independent exponential, and a disagreement that must be seen."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest

from design import discretise
from design.discretise import exponential_minus_identity, sample, transfer_from_polynomials, transfer_function
from design.linearise import linearise, subsystem
from design.loop import plant_polynomials
from records.errors import VerificationFailed
from sim.equilibrium import equilibrium
from tests.design.helicopter import SAMPLE_PERIOD_S, helicopter


def elevation(psi_rad: float):
    return subsystem(helicopter(), linearise(helicopter(), equilibrium(helicopter(), psi_rad)), "elevation")


def test_elevation_at_the_horizontal_has_the_published_coefficients():
    found = transfer_function(elevation(0.0), SAMPLE_PERIOD_S, "elevation")
    np.testing.assert_allclose(found.b, [0.0, 3.469e-6, 1.361e-5, 3.338e-6], rtol=5e-4)
    np.testing.assert_allclose(found.a, [1.0, -2.92574, 2.85178, -0.92603], atol=6e-6)


def test_zeros_are_the_sampling_zeros_that_no_design_may_cancel():
    found = transfer_function(elevation(0.0), SAMPLE_PERIOD_S, "elevation")
    np.testing.assert_allclose(sorted(np.roots(found.b[1:])), [-3.66, -0.263], rtol=2e-3)


@pytest.mark.parametrize("size", [1e-3, 0.1, 1.0, 5.0])
def test_exponential_agrees_with_forty_digits(size):
    matrix = np.random.default_rng(3).standard_normal((5, 5)) * size
    with mpmath.workdps(40):
        exact = np.array((mpmath.expm(mpmath.matrix(matrix.tolist())) - mpmath.eye(5)).tolist(), dtype=float)
    np.testing.assert_allclose(exponential_minus_identity(matrix), exact, atol=1e-15 * np.max(np.abs(exact)))


@pytest.mark.parametrize("psi_deg", [-40.0, 0.0, 40.0])
def test_polynomials_in_gamma_give_the_transfer_function_of_python_control(psi_deg):
    linear = elevation(np.radians(psi_deg))
    published = transfer_function(linear, SAMPLE_PERIOD_S, "elevation")
    polynomials = plant_polynomials(sample(linear, SAMPLE_PERIOD_S))
    own = transfer_from_polynomials(polynomials.b, polynomials.a)
    np.testing.assert_allclose(own.a, published.a, atol=1e-12)
    np.testing.assert_allclose(own.b, published.b, rtol=1e-8, atol=1e-16)


def test_a_transfer_function_that_disagrees_with_the_exponential_is_refused(monkeypatch):
    def wrong(linear, sample_period_s):
        right = sample(linear, sample_period_s)
        return replace(right, N=right.N * (1.0 + 1e-4))

    monkeypatch.setattr(discretise, "sample", wrong)
    with pytest.raises(VerificationFailed, match=r"elevation at 3 deg.*differs"):
        transfer_function(elevation(0.0), SAMPLE_PERIOD_S, "elevation at 3 deg")
