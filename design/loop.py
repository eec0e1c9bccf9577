"""The linear closed loop at one angle, in powers of gamma = z - 1, where slow poles do not cancel against 1.

    z^3 A, z^3 B from the sampled plant by Faddeev and LeVerrier;  z^n P, z^n Q from the delta form, as delta = gamma / (1 + gamma)
    z^(3 + n) (A P + B Q) = 0  ->  gamma_i  ->  s_i = ln(1 + gamma_i) / Ts;      n = 3, or 4 with a roll-off

Poles of multiplicity m still move by (relative error)^(1/m): six equal poles at -8 rad/s are only known to about 0.05 rad/s in
double precision, in this basis, and to 0.3 rad/s in powers of z. Distinct poles do not have that trouble.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from design.direct_form import DeltaForm
from design.discretise import SampledPlant

Array = NDArray[np.float64]
Poles = NDArray[np.complex128]


@dataclass(frozen=True)
class OpenLoop:
    """L = B Q / (A P) as polynomials in gamma, ascending powers: b (4,), a (4,), q (n + 1,), p (n + 1,)."""

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
    a, b = np.zeros(n + 1, plant.N.dtype), np.zeros(n + 1, plant.N.dtype)
    a[n] = 1.0
    adjugate = np.eye(n, dtype=plant.N.dtype)
    for power in range(n - 1, -1, -1):
        b[power] = (plant.C @ adjugate @ plant.B)[0, 0]
        product = plant.N @ adjugate
        a[power] = -np.trace(product) / (n - power)
        adjugate = product + a[power] * np.eye(n)
    return PlantPolynomials(b, a, plant.sample_period_s)


def controller_polynomials(controller: DeltaForm) -> tuple[Array, Array]:
    """z^n Q and z^n P, ascending powers of gamma, shapes (n + 1,), n the order of P."""
    order = len(controller.p)
    # P = delta + z^-1 (c_0 - c_1 delta - c_2 delta^2 ..), so c_0 = 0 leaves a factor gamma: the integrator stays exact.
    p = _delta_power(order, 1) + controller.p[0] * _delta_power(order, 0, late=1)
    p = p - sum(c * _delta_power(order, power, late=1) for power, c in enumerate(controller.p[1:], start=1))
    q = sum(d * _delta_power(order, power) for power, d in enumerate(controller.q))
    return np.asarray(q), np.asarray(p)


@cache
def _delta_power(order: int, power: int, late: int = 0) -> Array:
    """z^(order - late) delta^power = gamma^power (1 + gamma)^(order - late - power), ascending in gamma, shape (order + 1,)."""
    steps = order - late - power
    return np.array([math.comb(steps, k - power) if k >= power else 0 for k in range(order + 1)], dtype=float)


def closed_loop_polynomial(loop: OpenLoop) -> Array:
    """z^(3 + n) (A P + B Q) of eq (24), ascending powers of gamma, shape (4 + n,)."""
    return np.asarray(np.convolve(loop.a, loop.p) + np.convolve(loop.b, loop.q))


def closed_loop_poles(loop: OpenLoop) -> Poles:
    """The poles s_i [rad/s] of the closed loop, shape (3 + n,)."""
    return to_rad_s(polynomial_roots(closed_loop_polynomial(loop)), loop.sample_period_s)


def controller_poles(controller: DeltaForm) -> Poles:
    """Roots gamma of z^n P; the controller is stable where |1 + gamma| <= 1."""
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
