"""Sampling with a zero-order hold: the transfer functions (20) and (21), and the same plant in powers of gamma = z - 1.

Poles of a few rad/s sampled at 10 ms crowd around z = 1, where a polynomial in z cancels. In gamma they spread around 0, so the
closed loop is judged there; eq (26) is solved in z^-1 as in the paper.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.linearise import LinearPlant
from records.errors import VerificationFailed

Array = NDArray[np.float64]

# Largest relative difference between the first impulse response samples of python-control's transfer function and of the
# matrix exponential; 6e-11 is what the conversion of a well-posed helicopter loses.
MAX_DISAGREEMENT = 1e-7

# |M| <= 1/4 after halving: the first term left out is below 1e-19.
TAYLOR_TERMS = 12


@dataclass(frozen=True)
class SampledPlant:
    """x(k+1) = (I + N) x(k) + B u(k), y = C x(k): the step N is kept apart from I because it is small."""

    N: Array
    B: Array
    C: Array
    sample_period_s: float


@dataclass(frozen=True)
class TransferFunction:
    """B(z)/A(z) of eq (20) in ascending powers of z^-1: b (4,) with b[0] = 0, a (4,) with a[0] = 1."""

    b: Array
    a: Array


def sample(linear: LinearPlant, sample_period_s: float) -> SampledPlant:
    """Zero-order hold by one matrix exponential: [N, B; 0, 0] = exp([A, B; 0, 0] Ts) - I."""
    n, m = linear.B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = linear.A, linear.B
    step = exponential_minus_identity(block * sample_period_s)
    return SampledPlant(step[:n, :n], step[:n, n:], linear.C, sample_period_s)


def exponential_minus_identity(M: Array) -> Array:
    """exp(M) - I to rounding of the result, not of I: Taylor's series for M 2^-k, then k doublings N <- 2 N + N^2.

    Independent of the Pade approximation that python-control samples with.
    """
    halvings = max(0, math.ceil(math.log2(float(np.linalg.norm(M, 1)) + 1e-300)) + 2)
    small = M / 2.0**halvings
    identity = np.eye(len(M))
    total = identity.copy()
    for order in range(TAYLOR_TERMS, 1, -1):
        total = identity + small @ total / order
    step = small @ total
    for _ in range(halvings):
        step = 2.0 * step + step @ step
    return np.asarray(step)


def transfer_function(linear: LinearPlant, sample_period_s: float, where: str) -> TransferFunction:
    """The paper's c2d and ss2tf by python-control, for one input and one output.

    Raises VerificationFailed naming `where` when its impulse response differs from that of the matrix exponential.
    """
    import control  # half a second, which whoever only reads a table is spared

    continuous = control.ss(linear.A, linear.B, linear.C, np.zeros((1, 1)))
    discrete = control.ss2tf(control.sample_system(continuous, sample_period_s, method="zoh"))
    a = np.asarray(discrete.den[0][0], dtype=float)
    b = np.asarray(discrete.num[0][0], dtype=float)
    result = TransferFunction(b=np.append(np.zeros(len(a) - len(b)), b) / a[0], a=a / a[0])
    _check(result, sample(linear, sample_period_s), where)
    return result


def transfer_from_polynomials(b_gamma: Array, a_gamma: Array) -> TransferFunction:
    """The same transfer function from polynomials in gamma = z - 1, ascending powers, shapes (4,)."""
    shifts = [np.atleast_1d(np.poly(np.ones(power))) for power in range(len(a_gamma))]

    def in_z(ascending: Array) -> Array:
        total = np.zeros(len(ascending))
        for coefficient, shift in zip(ascending, shifts, strict=True):
            total[len(total) - len(shift) :] += coefficient * shift
        return total

    return TransferFunction(b=in_z(b_gamma), a=in_z(a_gamma))


def _check(found: TransferFunction, sampled: SampledPlant, where: str) -> None:
    count = 2 * len(found.a)
    wanted = _markov(sampled, count)
    difference = float(np.max(np.abs(_impulse_response(found, count) - wanted)) / np.max(np.abs(wanted)))
    if not difference < MAX_DISAGREEMENT:
        raise VerificationFailed(
            f"{where}: the sampled transfer function differs from the matrix exponential by {difference:.1e} "
            f"of its largest impulse response sample (limit {MAX_DISAGREEMENT:g})"
        )


def _markov(sampled: SampledPlant, count: int) -> Array:
    """C (I + N)^(k-1) B for k = 1 .. count, after a 0 for k = 0."""
    state, response = sampled.B[:, 0], [0.0]
    for _ in range(count):
        response.append(float(sampled.C[0] @ state))
        state = state + sampled.N @ state
    return np.array(response)


def _impulse_response(transfer: TransferFunction, count: int) -> Array:
    response: list[float] = []
    for k in range(count + 1):
        past = sum(transfer.a[i] * response[k - i] for i in range(1, min(k, len(transfer.a) - 1) + 1))
        response.append(float((transfer.b[k] if k < len(transfer.b) else 0.0) - past))
    return np.array(response)
