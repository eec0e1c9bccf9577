"""The rule that tunes the PID: the largest integral gain whose loop stays robust at every operating point.

    maximise k_i over (k_p, k_i, k_d)   subject to   max over omega and Psi of |1 / (1 + C G)| <= Ms_max,   k_i <= k_p^2 / (4 k_d)   (C.3)
    C(z) = k_p + k_i Ts / (z - 1) + (k_d / Tf) (1 - g z / (z - 1 + g)),   g = 1 - exp(-Ts/Tf),   Tf = k_d / (10 k_p)

which is the rule of Astrom, Panagopoulos and Hagglund (Automatica 34, 1998: largest integral gain under a bound on the
sensitivity), with the zeros of the PID kept real, Ti >= 4 Td (without it the azimuth overshoots by 55 %), and asked for at all operating
points at once, as one set of gains must fly them all. For each (k_p, k_d) the largest
k_i is found by bisection; (k_p, k_d) by Nelder and Mead's simplex from a fixed start, so the same plant gives the same gains.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.discretise import SampledPlant
from records.errors import BadInput
from records.table import lag_gain

Array = NDArray[np.float64]

# 2 is the usual bound. With one set of gains from -40 to 40 deg the CE150's elevation cannot be held below 2.5 (its pole at +40 deg is
# at +2.2 rad/s, its rotor's at -7), so it gets 3.
LARGEST_SENSITIVITY = {"elevation": 3.0, "azimuth": 2.0}
DERIVATIVE_SHARE = 10.0  # Td / Tf
FREQUENCIES = 160
BISECTIONS = 12
_RATIOS = np.geomspace(1.0, 0.01, 12)[::-1]  # of k_i to its most with real zeros, where bisection starts
_STARTS = {"elevation": (4.0, 2.0), "azimuth": (7.0, 5.0)}


@dataclass(frozen=True)
class Tuning:
    """Gains in V/rad, V/(rad s), V s/rad, the derivative's filter, and the sensitivity reached."""

    k_p: float
    k_i: float
    k_d: float
    filter_s: float
    sensitivity: float


@dataclass(frozen=True, eq=False)
class _Loop:
    """The sampled plants of one axis and their responses G (points, frequencies) at z (frequencies,)."""

    plants: Sequence[SampledPlant]
    z: NDArray[np.complex128]
    G: NDArray[np.complex128]

    @property
    def Ts_s(self) -> float:
        return self.plants[0].sample_period_s


def tune(plants: Sequence[SampledPlant], axis: str) -> Tuning:
    """(C.3) for the sampled plants of one axis; raises BadInput where no gains near the start hold the bound."""
    from scipy.optimize import minimize  # half a second, which whoever flies another controller is spared

    loop, bound = _loop(plants), LARGEST_SENSITIVITY[axis]

    def cost(x: Array) -> float:
        k_p, k_d = np.exp(x)
        k_i = _largest_integral(loop, k_p, k_d, bound)
        return -math.log(k_i) if k_i > 0.0 else 10.0 + _sensitivity(loop, k_p, 0.02 * k_p, k_d)

    found = minimize(
        cost, np.log(_STARTS[axis]), method="Nelder-Mead", options={"maxiter": 60, "xatol": 1e-3, "fatol": 1e-3}
    )
    k_p, k_d = (float(value) for value in np.exp(found.x))
    k_i = float(_largest_integral(loop, k_p, k_d, bound))
    if k_i == 0.0:
        raise BadInput(
            f"PID of the {axis}", "controller design", "no gains with that robustness at every operating point",
            f"max |1/(1 + L)| <= {bound:g}", "narrow psi_min_rad..psi_max_rad of [design]",
        )  # fmt: skip
    return Tuning(k_p, k_i, k_d, _filter_s(loop, k_p, k_d), _sensitivity(loop, k_p, k_i, k_d))


def _loop(plants: Sequence[SampledPlant]) -> _Loop:
    Ts_s = plants[0].sample_period_s
    z = np.exp(1j * np.geomspace(0.02, math.pi / Ts_s, FREQUENCIES) * Ts_s)
    gamma = (z - 1.0)[:, np.newaxis, np.newaxis] * np.eye(3)
    G = [
        (plant.C @ np.linalg.solve(gamma - plant.N, np.broadcast_to(plant.B, (len(z), 3, 1))))[:, 0, 0]
        for plant in plants
    ]
    return _Loop(plants, z, np.array(G))


def _filter_s(loop: _Loop, k_p: float, k_d: float) -> float:
    """Tf = Td / 10, but no faster than the sampling can filter."""
    return max(k_d / (DERIVATIVE_SHARE * k_p), 2.0 * loop.Ts_s)


def _largest_integral(loop: _Loop, k_p: float, k_d: float, bound: float) -> float:
    """The largest k_i within the bound, 0 where there is none."""

    def holds(k_i: float) -> bool:
        return _sensitivity(loop, k_p, k_i, k_d) <= bound

    real_zeros = k_p * k_p / (4.0 * k_d)
    held = [ratio * real_zeros for ratio in _RATIOS if holds(ratio * real_zeros)]
    if not held or max(held) == real_zeros:
        return float(max(held, default=0.0))
    low = float(max(held))
    high = low * float(_RATIOS[1] / _RATIOS[0])
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def _sensitivity(loop: _Loop, k_p: float, k_i: float, k_d: float) -> float:
    """The largest |1/(1 + C G)| over frequencies and operating points; infinite where a loop is unstable."""
    filter_s = _filter_s(loop, k_p, k_d)
    g = lag_gain(filter_s, loop.Ts_s)
    C = k_p + k_i * loop.Ts_s / (loop.z - 1.0) + k_d / filter_s * (1.0 - g * loop.z / (loop.z - 1.0 + g))
    largest = float(np.max(np.abs(1.0 / (1.0 + loop.G * C))))
    return largest if largest > 20.0 or _is_stable(loop, k_p, k_i, k_d / filter_s, g) else math.inf


def _is_stable(loop: _Loop, k_p: float, k_i: float, k_f: float, g: float) -> bool:
    """Whether all closed loops x, I, y_f have their eigenvalues inside the unit circle."""
    closed = np.zeros((len(loop.plants), 5, 5))
    for matrix, plant in zip(closed, loop.plants, strict=True):
        feedback = np.concatenate([-(k_p + k_f * (1.0 - g)) * plant.C[0], [1.0, k_f * (1.0 - g)]])
        matrix[:3, :3] = np.eye(3) + plant.N
        matrix[:3] += plant.B @ feedback[np.newaxis]
        matrix[3, :3], matrix[3, 3] = -k_i * loop.Ts_s * plant.C[0], 1.0
        matrix[4, :3], matrix[4, 4] = g * plant.C[0], 1.0 - g
    return bool(np.max(np.abs(np.linalg.eigvals(closed))) < 1.0)
