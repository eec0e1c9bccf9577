"""The gains of controllers/lqg.py at one operating point: the loop's sampled plant, its regulator and its filter.

In moves from sample to sample, y the output, x = (y, its move, ..) of n + 1 numbers, w the move of the input in the output's unit,

    x+ = A x + B w,   A = [1, e' G; 0, G],  B = (b_1, b),  G = I + shift - a e',   v = g w                                      (C.8)
    minimise sum exp(2 alpha t) w^2                                                                                            (C.9)
    the covariance of x, which nothing pushes, from readings of y that count exp(2 beta t)                                    (C.10)

with z^n A = gamma^n + a_1 gamma^(n-1) + .. and g z^n B = b_1 gamma^(n-1) + .., gamma = z - 1, and 1/g the size of the plant's B at
alpha: g alone bears most of what the plant changes by over a schedule. (C.9) is the regulator of prescribed stability (Anderson and
Moore, Optimal Control, 1990, section 3.5) for the cheapest input, (C.10) its dual, the filter of data that count less the older they are
(Anderson, Information Sciences 5, 1973). Both have their answers in closed form: a pole to the right of -alpha, or of the filter -beta,
goes to its mirror image there, the others stay. So the integrator of the moves goes to -2 alpha, and a mode that swings left of -alpha is
left alone.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.loop import PlantPolynomials
from design.schedule import NOISE
from design.settings import AxisSettings

Array = NDArray[np.float64]

# alpha and beta as multiples of the loop's slowest wished pole: what comes from the plant file is a speed, these say how much faster a law
# may be that needs no filter before its reference, and how much faster its filter. Judged on spread plants of ce150, quanser_aero,
# aeroshield, a motor, an inverted arm, a drum's level, two heaters, two coupled arms and an elastic shaft, measured at either end. ce150
# binds the first: 1.4 costs its elevation 12 deg s more than the 69 of 1.85, which overshoots by 1.8 % at worst, and 2.1 overshoots by 8 %.
# quanser_aero binds the second: 7 overshoots by 6 %; 10 lets through 1.7 times the travel on ce150.
REGULATOR_SPEED, FILTER_SPEED = 1.85, 8.0


@dataclass(frozen=True)
class Gains:
    """a, b of (C.8), (n,); the regulator's k and the filter's l, (n + 1,); g [V/rad], V and rad as in records/loops.py."""

    a: Array
    b: Array
    k: Array
    l: Array  # noqa: E741  # the field's letter
    g: float


@dataclass(frozen=True)
class Speeds:
    """alpha of (C.9) and beta of (C.10) [rad/s]."""

    regulator_rad_s: float
    filter_rad_s: float


@dataclass(frozen=True)
class Share:
    """How much of the wished speed of each a regulator and its filter have."""

    regulator: float
    filter: float


def wished_speeds(wishes: AxisSettings, share: Share) -> Speeds:
    """This share of those that the wished poles ask for."""
    slowest_rad_s = float(np.min(np.abs(np.array(wishes.placed_rad_s))))
    return Speeds(share.regulator * REGULATOR_SPEED * slowest_rad_s, share.filter * (FILTER_SPEED * slowest_rad_s))


def gains_at(plant: PlantPolynomials, speeds: Speeds) -> Gains:
    """All coefficients of controllers/lqg.py at one operating point.

    Raises numpy's LinAlgError where no regulator exists: an input that moves the output for a moment only.
    """
    order, Ts_s = len(plant.a) - 1, plant.sample_period_s
    alpha, beta = speeds.regulator_rad_s * Ts_s, speeds.filter_rad_s * Ts_s
    a = _without_noise(plant.a[order - 1 :: -1], alpha)
    b = _without_noise(plant.b[order - 1 :: -1], alpha)
    of_x, g = _scales(b, alpha)
    A, B = _in_moves(a, b * g, of_x)
    k = _placed(A, B, _mirrored(A, alpha)) / of_x
    of_x, _ = _scales(b, beta)
    A, _ = _in_moves(a, b, of_x)
    predicted = _placed(A.T, np.eye(1, order + 1)[0], _mirrored(A, beta))
    return Gains(a, b * g, k, of_x * np.linalg.solve(A, predicted), g)


def _without_noise(coefficients: Array, step: float) -> Array:
    """Coefficients of falling powers of gamma, 0 where rounding alone left them beside the others at |gamma| = `step`."""
    sizes = np.abs(coefficients) / step ** np.arange(1, len(coefficients) + 1)
    return np.where(sizes > NOISE * float(np.max(sizes)), coefficients, 0.0)


def _scales(b: Array, step: float) -> tuple[Array, float]:
    """Units of x (n + 1,) in which all numbers are near 1 at |gamma| = `step`, and of the input, in which B there is as large as 1."""
    of_x: Array = np.power(step, np.arange(len(b) + 1))
    return of_x, 1.0 / float(np.linalg.norm(np.append(b[0], b) / of_x))


def _in_moves(a: Array, b: Array, of_x: Array) -> tuple[Array, Array]:
    """A and B of (C.8) in the units of x."""
    order = len(a)
    G = np.eye(order) + np.eye(order, k=1)
    G[:, 0] -= a
    A = np.eye(order + 1)
    A[1:, 1:] = G
    A[0, 1:] = G[0]
    return A * of_x / of_x[:, np.newaxis], np.append(b[0], b) / of_x


def _mirrored(A: Array, alpha: float) -> NDArray[np.complex128]:
    """The poles z (n,) of A, those to the right of -alpha mirrored there; `alpha` times the sample period."""
    s = np.log(np.linalg.eigvals(A).astype(complex))
    return np.asarray(np.exp(np.where(s.real > -alpha, -2.0 * alpha - s.real, s.real) + 1j * s.imag))


def _placed(A: Array, B: Array, poles: NDArray[np.complex128]) -> Array:
    """k (n,) of A - B k' with these poles, by Ackermann's formula in gamma, in units of the fastest of them."""
    order = len(A)
    unit = float(np.max(np.abs(poles - 1.0)))
    N, reached = (A - np.eye(order)) / unit, np.empty((order, order))
    wanted = np.zeros((order, order))
    reached[:, 0] = B / unit
    for column in range(1, order):
        reached[:, column] = N @ reached[:, column - 1]
    for coefficient in np.poly((poles - 1.0) / unit).real:
        wanted = wanted @ N + coefficient * np.eye(order)
    return np.asarray(np.linalg.solve(reached.T, np.eye(order)[-1]) @ wanted)
