"""The linear closed loop at one angle, in powers of gamma = z - 1, where slow poles do not cancel against 1.

    z^3 A, z^3 B from the sampled plant by Faddeev and LeVerrier;  z^3 P, z^3 Q from the delta form, as delta = gamma / (1 + gamma)
    z^6 (A P + B Q) = 0  ->  gamma_i  ->  s_i = ln(1 + gamma_i) / Ts

Poles of multiplicity m still move by (relative error)^(1/m): six equal poles at -8 rad/s are only known to about 0.05 rad/s in
double precision, in this basis, and to 0.3 rad/s in powers of z. Distinct poles do not have that trouble.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.direct_form import DeltaForm
from design.discretise import SampledPlant

Array = NDArray[np.float64]
Poles = NDArray[np.complex128]

# Coefficients, ascending in gamma, of (1 + gamma)^3, gamma (1 + gamma)^2, gamma^2 (1 + gamma), gamma^3: z^3 delta^k, k = 0 .. 3.
_DELTA_POWERS = np.array([[1.0, 3.0, 3.0, 1.0], [0.0, 1.0, 2.0, 1.0], [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]])
# z^2 delta^k, k = 0 .. 2, in the same powers.
_DELTA_POWERS_LATE = np.array([[1.0, 2.0, 1.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 0.0]])


@dataclass(frozen=True)
class OpenLoop:
    """L = B Q / (A P) as polynomials in gamma, ascending powers: shapes (4,) each."""

    b: Array
    a: Array
    q: Array
    p: Array
    sample_period_s: float


@dataclass(frozen=True)
class PlantPolynomials:
    """z^n B = b and z^n A = a of a sampled plant of order n, ascending powers of gamma, shapes (n + 1,)."""

    b: Array
    a: Array
    sample_period_s: float


def open_loop(plant: PlantPolynomials, controller: DeltaForm) -> OpenLoop:
    """The loop of a single-input plant of order 3 and a controller in delta form."""
    q, p = controller_polynomials(controller)
    return OpenLoop(plant.b, plant.a, q, p, plant.sample_period_s)


def plant_polynomials(plant: SampledPlant) -> PlantPolynomials:
    """b = C adj(gamma I - N) B and a = det(gamma I - N) by Faddeev and LeVerrier."""
    n = len(plant.N)
    a, b = np.zeros(n + 1), np.zeros(n + 1)
    a[n] = 1.0
    adjugate = np.eye(n)
    for power in range(n - 1, -1, -1):
        b[power] = (plant.C @ adjugate @ plant.B)[0, 0]
        product = plant.N @ adjugate
        a[power] = -np.trace(product) / (n - power)
        adjugate = product + a[power] * np.eye(n)
    return PlantPolynomials(b, a, plant.sample_period_s)


def controller_polynomials(controller: DeltaForm) -> tuple[Array, Array]:
    """z^3 Q and z^3 P, ascending powers of gamma, shapes (4,)."""
    c_0, c_1, c_2 = controller.p
    # P = delta + z^-1 (c_0 - c_1 delta - c_2 delta^2), so c_0 = 0 leaves a factor gamma: the integrator stays exact.
    p = _DELTA_POWERS[1] + np.array([c_0, -c_1, -c_2]) @ _DELTA_POWERS_LATE
    return controller.q @ _DELTA_POWERS, p


def closed_loop_polynomial(loop: OpenLoop) -> Array:
    """z^6 (A P + B Q) of eq (24), ascending powers of gamma, shape (7,)."""
    return np.asarray(np.convolve(loop.a, loop.p) + np.convolve(loop.b, loop.q))


def closed_loop_poles(loop: OpenLoop) -> Poles:
    """The six poles s_i [rad/s] of the closed loop."""
    return to_rad_s(polynomial_roots(closed_loop_polynomial(loop)), loop.sample_period_s)


def controller_poles(controller: DeltaForm) -> Poles:
    """Roots gamma of z^3 P; the controller is stable where |1 + gamma| <= 1."""
    return polynomial_roots(controller_polynomials(controller)[1])


def to_rad_s(gamma: Poles, sample_period_s: float) -> Poles:
    """s = ln(1 + gamma)/Ts; a pole at z = 0 becomes -inf, which is as fast as can be."""
    with np.errstate(divide="ignore"):
        logarithm = np.log1p(gamma.astype(complex))
    result: Poles = np.empty(logarithm.shape, dtype=complex)
    # Parts are divided on their own: a complex division would make NaN of -inf + 0j.
    result.real, result.imag = logarithm.real / sample_period_s, logarithm.imag / sample_period_s
    return result


def polynomial_roots(ascending: Array) -> Poles:
    """Roots, shape (..., n), of polynomials in gamma, shape (..., n + 1), as eigenvalues of companion matrices.

    gamma is first scaled by the geometric mean of the roots that are not exactly 0, so that the matrix is balanced.
    """
    degree = ascending.shape[-1] - 1
    first = np.argmax(ascending != 0.0, axis=-1)[..., np.newaxis]
    lowest = np.take_along_axis(ascending, first, axis=-1)
    size = np.abs(lowest / ascending[..., -1:]) ** (1.0 / np.maximum(degree - first, 1))
    scaled = ascending * size ** np.arange(degree + 1)
    companion = np.zeros((*ascending.shape[:-1], degree, degree))
    companion[..., 0, :] = -scaled[..., -2::-1] / scaled[..., -1:]
    companion[..., np.arange(1, degree), np.arange(degree - 1)] = 1.0
    return np.asarray(np.linalg.eigvals(companion) * size, dtype=complex)


def slowest(poles: Poles) -> float:
    """The largest real part [rad/s]: above 0 the loop is unstable."""
    return float(np.max(poles.real))
