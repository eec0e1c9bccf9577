"""Sampling with a zero-order hold: the plant as x(k+1) = (I + N) x(k) + B u(k)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.linear_plant import LinearPlant

Array = NDArray[np.float64]

# |M| <= 1/4 after halving: the first term left out is below 1e-23, less than what 64 bits tell apart.
TAYLOR_TERMS = 16


@dataclass(frozen=True)
class SampledPlant:
    """x(k+1) = (I + N) x(k) + B u(k), y = C x(k): the step N is kept apart from I because it is small."""

    N: Array
    B: Array
    C: Array
    sample_period_s: float


def extended(linear: LinearPlant) -> LinearPlant:
    """The same plant in numbers of 64 bits instead of 53, where the processor has them; what is worked out of them is so too."""
    return LinearPlant(*(np.asarray(matrix, dtype="longdouble") for matrix in (linear.A, linear.B, linear.C)))


def sample(linear: LinearPlant, sample_period_s: float) -> SampledPlant:
    """Zero-order hold by one matrix exponential: [N, B; 0, 0] = exp([A, B; 0, 0] Ts) - I."""
    n, m = linear.B.shape
    block = np.zeros((n + m, n + m), dtype=linear.A.dtype)
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
