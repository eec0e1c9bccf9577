"""The gains of controllers/lqg.py at one operating point: the loop's sampled plant, its regulator and its filter.

In moves from sample to sample, y the output, x = (y, its move, ..) of n + 1 numbers, v the move of the input,

    x+ = A x + B v,   A = [1, e' G; 0, G],  B = (b_1, b),  G = I + shift - a e'                                                  (C.8)
    minimise sum (y + dy/dt / s)^2 + rho v^2                                                                                  (C.9)
    the covariance of x under input moves of variance lambda, y measured with variance 1                                       (C.10)

with a and b of z^n A = gamma^n + a_1 gamma^(n-1) + .. and z^n B = b_1 gamma^(n-1) + .., gamma = z - 1. Both gains come from discrete
Riccati equations (Anderson and Moore, Optimal Control, 1990, chapters 3 and 8). One speed rules all, the geometric mean of the wished
poles: s is DAMPING_SPEED of it, a zero that draws a pole and damps the others; rho and 1/lambda are the largest that give the regulator's
and the filter's poles the geometric means REGULATOR_SPEED and FILTER_SPEED of it, and none a distance below LEAST_SHARE of that mean.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.equations.designing import mean_speed_rad_s
from design.loop import PlantPolynomials
from design.schedule import NOISE
from design.settings import AxisSettings

Array = NDArray[np.float64]

# Shares of the wished speed, chosen on sixty spread CE150 of seed 101 through Fig. 23, where the elevation's median IAE is 68 deg s, its
# largest overshoot 5 % and the voltage's travel 2.5 V/s. A damping of 0.5 overshoots by 6 %; a regulator of 0.7 needs 2 deg s more, one of
# 1.0 is left a delay margin of 16 ms; a filter of 3.0 holds no max |1/(1 + L)| below 2.4.
DAMPING_SPEED, REGULATOR_SPEED, FILTER_SPEED = 0.42, 0.74, 4.5
# A plant that is faster than its wished poles would leave the integral behind: aeroshield's, a quarter of the mean, rested 0.3 deg off
# after two seconds. Of the other rigs' regulators no pole is below 0.55. It must be well below DAMPING_SPEED / REGULATOR_SPEED, which the
# slowest pole never passes.
LEAST_SHARE = 0.45
# Decades about an input as strong as the output within which rho and lambda are sought.
DECADES = 16.0
SHARE = 1e-13  # of a decade, where the search ends: a table holds eight digits, the same on every processor


@dataclass(frozen=True)
class Gains:
    """a and b of (C.8), (n,); the regulator's k and the filter's l, (n + 1,)."""

    a: Array
    b: Array
    k: Array
    l: Array  # noqa: E741  # the field's letter


@dataclass(frozen=True)
class _Scaled:
    """(C.8) in units in which all numbers are near 1: those of x in `of_x` (n + 1,), of v in `of_v`."""

    A: Array
    B: Array
    of_x: Array
    of_v: float


@dataclass(frozen=True)
class Speeds:
    """s of (C.9), and the geometric means of the regulator's and of the filter's poles, as distances from the origin [rad/s]."""

    damping_rad_s: float
    regulator_rad_s: float
    filter_rad_s: float


def gains_at(plant: PlantPolynomials, speeds: Speeds) -> Gains:
    """All coefficients of controllers/lqg.py at one operating point.

    Raises ArithmeticError (LinAlgError) where no regulator exists: an input that moves the output for a moment only.
    """
    order, Ts_s = len(plant.a) - 1, plant.sample_period_s
    a, b = plant.a[order - 1 :: -1], plant.b[order - 1 :: -1]
    damping, regulator, observer = (speed * Ts_s for speed in vars(speeds).values())
    a, b = _without_noise(a, regulator), _without_noise(b, regulator)
    k = _regulator(_scaled(a, b, regulator), damping, regulator)
    return Gains(a, b, k, _filter(_scaled(a, b, observer), observer))


def wished_speeds(wishes: AxisSettings, share: float) -> Speeds:
    """This share of the speeds that the wished poles ask for."""
    mean_rad_s = share * mean_speed_rad_s(wishes)
    return Speeds(*(part * mean_rad_s for part in (DAMPING_SPEED, REGULATOR_SPEED, FILTER_SPEED)))


def _without_noise(coefficients: Array, step: float) -> Array:
    """Coefficients of falling powers of gamma, 0 where rounding alone left them beside the others at |gamma| = `step`."""
    sizes = np.abs(coefficients) / step ** np.arange(1, len(coefficients) + 1)
    return np.where(sizes > NOISE * float(np.max(sizes)), coefficients, 0.0)


def _scaled(a: Array, b: Array, step: float) -> _Scaled:
    order = len(a)
    G = np.eye(order) + np.eye(order, k=1)
    G[:, 0] -= a
    A, B = np.eye(order + 1), np.append(b[0], b)
    A[1:, 1:] = G
    A[0, 1:] = G[0]
    of_x: Array = np.power(step, np.arange(order + 1))
    within = B / of_x
    of_v = 1.0 / float(np.linalg.norm(within))
    return _Scaled(A * of_x / of_x[:, np.newaxis], (within * of_v)[:, np.newaxis], of_x, of_v)


def _regulator(plant: _Scaled, damping: float, speed: float) -> Array:
    """k of v = -k x that minimises (C.9); `damping` and `speed` are distances from the origin times the sample period."""
    wanted = np.zeros((1, len(plant.A)))
    wanted[0, :2] = 1.0, plant.of_x[1] / damping
    Q = wanted.T @ wanted
    rho = _weight(plant.A, plant.B, Q, speed)
    X = _riccati(plant.A, plant.B, Q, rho)
    gain = (plant.B.T @ X @ plant.A)[0] / (rho + (plant.B.T @ X @ plant.B)[0, 0])
    return np.asarray(plant.of_v * gain / plant.of_x)


def _filter(plant: _Scaled, speed: float) -> Array:
    """l of x <- x + l (measured - y): the steady-state Kalman filter of (C.10)."""
    C = np.eye(1, len(plant.A))
    Q = plant.B @ plant.B.T
    noise = _weight(plant.A.T, C.T, Q, speed)
    P = _riccati(plant.A.T, C.T, Q, noise)
    return np.asarray(plant.of_x * P[:, 0] / (P[0, 0] + noise))


def _weight(A: Array, B: Array, Q: Array, speed: float) -> float:
    """The R at which the closed loop is as fast as `speed`, see `_speed`: the dearer the input, the slower it is."""
    low, high = -DECADES, DECADES
    while high - low > SHARE:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _speed(A, B, Q, 10.0**middle) > speed else (low, middle)
    return float(10.0 ** (0.5 * (low + high)))


def _speed(A: Array, B: Array, Q: Array, R: float) -> float:
    """The geometric mean of |ln z| of the closed loop, or what LEAST_SHARE makes of its least, if that is less; from the stable half of the
    Riccati equation's symplectic matrix.
    """
    back = np.linalg.inv(A).T
    push = B @ B.T / R
    pencil = np.block([[A + push @ back @ Q, -push @ back], [-back @ Q, back]])
    z = np.linalg.eigvals(pencil)
    stable = z[np.argsort(np.abs(z))][: len(A)]
    sizes = np.abs(np.log(stable.astype(complex) + np.finfo(float).tiny))  # a pole at z = 0 is fast, not an error
    return min(math.exp(float(np.mean(np.log(sizes)))), float(np.min(sizes)) / LEAST_SHARE)


def _riccati(A: Array, B: Array, Q: Array, R: float) -> Array:
    """X = A'XA - A'XB (R + B'XB)^-1 B'XA + Q."""
    from scipy.linalg import solve_discrete_are  # half a second, which whoever flies another controller is spared

    return np.asarray(solve_discrete_are(A, B, Q, np.array([[R]])))
