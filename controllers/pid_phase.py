"""What the phase of a plant leaves to a PID: by how much it lags, and by how much it may.

    lag(omega) = sum_i arg(z - p_i) - sum_i arg(z - z_i),   z = exp(i omega Ts),   p_i poles, z_i zeros of the sampled plant
    lead of k_p + k_d s / (1 + s Tf) <= asin(N / (N + 2)),   N = k_d / (k_p Tf),   less with an integral
    |1 / (1 + L)| <= M at |L| = 1   <=>   L is 2 asin(1 / (2 M)) and more from -180 deg

A steady sum of angles, and not the angle of G: it does not jump by turns, so five integrators lag by 450 deg, not by 90.
"""

import math

import numpy as np
from numpy.typing import NDArray

from design.discretise import SampledPlant
from design.loop import plant_polynomials, polynomial_roots


def lag_rad(plant: SampledPlant, z: NDArray[np.complex128]) -> NDArray[np.float64]:
    """The lag [rad] of a sampled plant at z on the unit circle, shape (frequencies,)."""
    found = plant_polynomials(plant)
    b, a = np.trim_zeros(found.b, "b"), found.a
    gamma = (z - 1.0)[:, np.newaxis]
    zeros, poles = (polynomial_roots(entry) if len(entry) > 1 else np.empty(0) for entry in (b, a))
    angles = np.angle(gamma - poles).sum(axis=1) - np.angle(gamma - zeros).sum(axis=1)
    return np.asarray(angles + (math.pi if b[-1] < 0.0 else 0.0))


def most_lag_rad(derivative_share: float, sensitivity: float) -> float:
    """By how much a plant may lag [rad] where its loop with a PID of k_d / (k_p Tf) = `derivative_share` crosses a gain of one."""
    lead = math.asin(derivative_share / (derivative_share + 2.0))
    return math.pi + lead - 2.0 * math.asin(1.0 / (2.0 * sensitivity))
