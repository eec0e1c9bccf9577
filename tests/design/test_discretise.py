"""Sampling: the published numbers, an independent exponential, and a disagreement that must be seen."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest

from design import transfer
from design.discretise import exponential_minus_identity, sample
from design.linearise import linearise, subsystem
from design.transfer import transfer_function
from records.errors import VerificationFailed
from records.loops import LOOPS
from sim.equilibrium import equilibrium
from tests.design.helicopter import SAMPLE_PERIOD_S, helicopter


def elevation(psi_rad: float):
    return subsystem(helicopter(), linearise(helicopter(), equilibrium(helicopter(), psi_rad)), LOOPS[0])


def test_elevation_at_the_horizontal_has_the_published_coefficients():
    found = transfer_function(elevation(0.0), SAMPLE_PERIOD_S, LOOPS[0])
    np.testing.assert_allclose(found.b, [0.0, 3.469e-6, 1.361e-5, 3.338e-6], rtol=5e-4)
    np.testing.assert_allclose(found.a, [1.0, -2.92574, 2.85178, -0.92603], atol=6e-6)


def test_zeros_are_the_sampling_zeros_that_no_design_may_cancel():
    found = transfer_function(elevation(0.0), SAMPLE_PERIOD_S, LOOPS[0])
    np.testing.assert_allclose(sorted(np.roots(found.b[1:])), [-3.66, -0.263], rtol=2e-3)


@pytest.mark.parametrize("size", [1e-3, 0.1, 1.0, 5.0])
def test_exponential_agrees_with_forty_digits(size):
    matrix = np.random.default_rng(3).standard_normal((5, 5)) * size
    with mpmath.workdps(40):
        exact = np.array((mpmath.expm(mpmath.matrix(matrix.tolist())) - mpmath.eye(5)).tolist(), dtype=float)
    np.testing.assert_allclose(exponential_minus_identity(matrix), exact, atol=1e-15 * np.max(np.abs(exact)))


@pytest.mark.parametrize("psi_deg", [-40.0, 0.0, 40.0])
def test_the_transfer_function_is_that_of_forty_digits(psi_deg):
    """B is kept to 1e-13 of its coefficients; the usual conversion keeps nine digits of it."""
    linear = elevation(np.radians(psi_deg))
    found = transfer_function(linear, SAMPLE_PERIOD_S, LOOPS[0])
    with mpmath.workdps(40):
        block = mpmath.zeros(4)
        for row in range(3):
            block[row, 3] = float(linear.B[row, 0])
            for column in range(3):
                block[row, column] = float(linear.A[row, column])
        step = mpmath.expm(block * SAMPLE_PERIOD_S)
        phi, gamma = step[:3, :3], step[:3, 3]
        a = _characteristic(phi)
        response = [0, *((mpmath.matrix(linear.C.tolist()) * phi**k * gamma)[0] for k in range(3))]
        b = [mpmath.fsum(a[i] * response[k - i] for i in range(k + 1)) for k in range(4)]
    np.testing.assert_allclose(found.a, np.array(a, dtype=float), atol=1e-15)
    np.testing.assert_allclose(found.b, np.array(b, dtype=float), rtol=1e-13)


def test_the_conversion_in_z_is_that_of_python_control():
    """To nine digits, which are what either has of B."""
    import control  # a second and a half of modules, which one worker alone is to load

    linear = elevation(0.3)
    plant = control.ss(linear.A, linear.B, linear.C, [[0.0]])
    expected = control.ss2tf(control.sample_system(plant, SAMPLE_PERIOD_S, method="zoh"))
    found = transfer._in_z(linear, SAMPLE_PERIOD_S, 1.0)
    np.testing.assert_allclose(found.a, expected.den[0][0], atol=1e-12)
    np.testing.assert_allclose(found.b[1:], expected.num[0][0], atol=1e-13)


def _characteristic(phi):
    """1, -tr, sum of the principal minors, -det."""
    minors = sum(phi[i, i] * phi[j, j] - phi[i, j] * phi[j, i] for i in range(3) for j in range(i))
    return [mpmath.mpf(1), -sum(phi[i, i] for i in range(3)), minors, -mpmath.det(phi)]


def test_a_transfer_function_that_disagrees_with_the_exponential_is_refused(monkeypatch):
    def wrong(linear, sample_period_s):
        right = sample(linear, sample_period_s)
        return replace(right, N=right.N * (1.0 + 1e-4))

    monkeypatch.setattr(transfer, "sample", wrong)
    with pytest.raises(VerificationFailed, match=r"elevation at 3 deg.*differs"):
        transfer_function(elevation(0.0), SAMPLE_PERIOD_S, "elevation at 3 deg")


@pytest.mark.parametrize("factor", [1e-15, 1e-9, 1e9])
@pytest.mark.parametrize("sample_period_s", [5e-4, SAMPLE_PERIOD_S, 0.05])
def test_the_unit_of_the_output_changes_nothing_but_the_size_of_b(factor, sample_period_s, monkeypatch):
    """Truth: B is linear in C. A plant in other units is as well known, and one that disagrees is refused in any."""
    linear = elevation(0.0)
    other = replace(linear, C=linear.C * factor)
    found, known = (transfer_function(plant, sample_period_s, "elevation") for plant in (other, linear))
    np.testing.assert_allclose(found.b, factor * known.b, rtol=1e-12)
    monkeypatch.setattr(transfer, "MAX_DISAGREEMENT", 1e-10)
    transfer_function(other, sample_period_s, "elevation")
    right = sample(other, sample_period_s)
    monkeypatch.setattr(transfer, "sample", lambda *_: replace(right, B=right.B * [[1.0], [1.0], [1.0 + 1e-6]]))
    with pytest.raises(VerificationFailed, match="differs"):
        transfer_function(other, sample_period_s, "elevation")


def test_an_input_that_never_reaches_the_output_is_refused():
    linear = elevation(0.0)
    with pytest.raises(VerificationFailed, match="impulse response"):
        transfer_function(replace(linear, C=0.0 * linear.C), SAMPLE_PERIOD_S, "elevation")
