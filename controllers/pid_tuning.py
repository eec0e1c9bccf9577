"""The rule that tunes the PID of a loop: the largest integral gain that stays robust at every operating point.

    maximise k_i over (k_p, k_i, k_d)   subject to   max over omega and Psi of |1 / (1 + C G)| <= Ms_max,   k_i <= k_p^2 / (4 k_d)   (C.3)
                                             and    |C G| < 1 from the geometric mean of the wished poles on
    C(z) = k_p + k_i Ts / (z - 1) + (k_d / Tf) (1 - g z / (z - 1 + g)),   g = 1 - exp(-Ts/Tf),   Tf = k_d / (10 k_p)

which is the rule of Astrom, Panagopoulos and Hagglund (Automatica 34, 1998: largest integral gain under a bound on the
sensitivity), with the zeros of the PID kept real, Ti >= 4 Td (without it the azimuth overshoots by 55 %), and asked for at all operating
points at once, as one set of gains must fly them all; a loop of one state would else be as fast as its sampling. Ms_max is the first
of SENSITIVITIES that any gains hold. For each (k_p, k_d) the largest k_i is found by bisection; (k_p, k_d) by Nelder and Mead's simplex,
the best from some starts that follow from the plant, so the same plant gives the same gains.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from controllers.equations.designing import Points, mean_speed_rad_s
from controllers.equations.judging import demand_held_at_rest
from controllers.pid_phase import lag_rad, most_lag_rad
from design.discretise import SampledPlant
from design.loop import plant_polynomials
from records.errors import BadInput
from records.table import lag_gain

Array = NDArray[np.float64]

# 2 is the usual bound. With one set of gains from -40 to 40 deg the CE150's elevation cannot be held below 2.5 (its pole at +40 deg is
# at +2.2 rad/s, its rotor's at -7), so it gets 3; beyond, a loop is not held but hangs on.
SENSITIVITIES = (2.0, 3.0)
NO_LOOP = 20.0  # of |1/(1 + L)|: no loop to begin from
DERIVATIVE_SHARE = 10.0  # Td / Tf
FREQUENCIES = 160
BISECTIONS = 12
_RATIOS = np.geomspace(
    1.0, 0.01, 12
).tolist()  # of k_i to its most with real zeros: bisection starts at the first that holds
# Of a gain to its start, which crosses one at the wished speed: 1e6 times less, no loop is left; without an end a search that nothing holds
# goes on to gains of 0.
WIDEST = 1e6
_STARTS = (0.25, 0.5, 1.0)  # crossovers as shares of the wished poles' geometric mean


@dataclass(frozen=True)
class Tuning:
    """Gains in V/rad, V/(rad s), V s/rad, the derivative's filter, the sensitivity reached and its bound; V and rad as in Loop."""

    k_p: float
    k_i: float
    k_d: float
    filter_s: float
    sensitivity: float
    Ms_max: float


@dataclass(frozen=True, eq=False)
class _Loop:
    """The sampled plants of one axis, all with a positive gain, and their responses G (points, frequencies) at z (frequencies,).

    `is_fast` (frequencies,) tells those at which a loop may have no gain left.
    """

    plants: Sequence[SampledPlant]
    z: NDArray[np.complex128]
    G: NDArray[np.complex128]
    is_fast: NDArray[np.bool_]

    @property
    def Ts_s(self) -> float:
        return self.plants[0].sample_period_s


def tune(points: Points, axis: str) -> Tuning:
    """(C.3) for the loop of one axis; raises BadInput where no gains near the starts hold any of the bounds."""
    demand_held_at_rest(points, axis)
    sign = _sign(points, axis)
    speed_rad_s = mean_speed_rad_s(points.settings.axis(axis))
    loop = _loop(points.sampled(axis), sign, speed_rad_s)
    for Ms_max in SENSITIVITIES:
        found = _best(loop, speed_rad_s, Ms_max)
        if found is not None:
            k_p, k_i, k_d = found
            filter_s, reached = _filter_s(loop, k_p, k_d), _sensitivity(loop, k_p, k_i, k_d)
            return Tuning(sign * k_p, sign * k_i, sign * k_d, filter_s, reached, Ms_max)
    wished = points.settings.loop(axis)
    raise BadInput(
        f"PID of the {axis}",
        f"plant {points.bound.plant.name!r}",
        f"no gains with that robustness at every operating point: up to {speed_rad_s:.2g} rad/s, the geometric mean of its wished poles, "
        f"{wished.output} lags {wished.input} by {_least_lag_deg(loop):.0f} deg and more",
        f"max |1/(1 + L)| <= {SENSITIVITIES[-1]:g}, which this PID can give where the lag is {_most_lag_deg():.0f} deg at most",
        f"{_narrower(points)}choose another controller: three gains hold about two states",
    )


def _least_lag_deg(loop: _Loop) -> float:
    """The least lag of the plant at the frequencies where its loop may cross a gain of one, at the operating point where that is most."""
    slow = loop.z[~loop.is_fast]
    return math.degrees(max(float(lag_rad(plant, slow).min()) for plant in loop.plants))


def _most_lag_deg() -> float:
    return math.degrees(most_lag_rad(DERIVATIVE_SHARE, SENSITIVITIES[-1]))


def _narrower(points: Points) -> str:
    return "" if points.settings.schedule is None else "narrow the schedule's range of [design], or "


def _best(loop: _Loop, speed_rad_s: float, bound: float) -> tuple[float, float, float] | None:
    """k_p, k_i and k_d of the largest k_i within the bound, None where no start leads to any."""
    from scipy.optimize import minimize  # half a second, which whoever flies another controller is spared

    def cost(x: Array) -> float:
        k_p, k_d = np.exp(x)
        k_i = _largest_integral(loop, k_p, k_d, bound)
        return -math.log(k_i) if k_i > 0.0 else 10.0 + _sensitivity(loop, k_p, 0.02 * k_p, k_d)

    best: tuple[float, float, float] | None = None
    for share in _STARTS:
        start = _start(loop, share * speed_rad_s)
        options = {"maxiter": 60, "xatol": 1e-3, "fatol": 1e-3}
        found = minimize(cost, np.log(start), method="Nelder-Mead", bounds=_within(start), options=options)
        k_p, k_d = (float(value) for value in np.exp(found.x))
        k_i = float(_largest_integral(loop, k_p, k_d, bound))
        if k_i > 0.0 and (best is None or k_i > best[1]):
            best = k_p, k_i, k_d
    return best


def _within(start: tuple[float, float]) -> list[tuple[float, float]]:
    """Where the logarithms of the gains are looked for."""
    return [(math.log(gain) - math.log(WIDEST), math.log(gain) + math.log(WIDEST)) for gain in start]


def _start(loop: _Loop, crossover_rad_s: float) -> tuple[float, float]:
    """k_p and k_d that share a gain of one at this frequency, at the middle operating point."""
    at = int(np.argmin(np.abs(np.angle(loop.z) / loop.Ts_s - crossover_rad_s)))
    gain = 1.0 / (math.sqrt(2.0) * abs(loop.G[len(loop.G) // 2, at]))
    return gain, gain / crossover_rad_s


def _sign(points: Points, axis: str) -> float:
    """Which way the output goes as the input rises; raises BadInput where that is not the same at all operating points."""
    step = mean_speed_rad_s(points.settings.axis(axis)) * points.settings.sample_period_s
    pushes = [float(np.polyval(plant_polynomials(plant).b[::-1], step)) for plant in points.sampled(axis)]
    if not (min(pushes) > 0.0 or max(pushes) < 0.0):
        got = "an input that pushes its output up at some operating points and down at others"
        remedy = f"{_narrower(points)}choose another controller"
        raise BadInput(f"PID of the {axis}", f"plant {points.bound.plant.name!r}", got, "one sign", remedy)
    return math.copysign(1.0, pushes[0])


def _loop(plants: Sequence[SampledPlant], sign: float, speed_rad_s: float) -> _Loop:
    Ts_s = plants[0].sample_period_s
    omega = np.geomspace(0.02, math.pi / Ts_s, FREQUENCIES)
    z = np.exp(1j * omega * Ts_s)
    turned = [replace(plant, C=sign * plant.C) for plant in plants]
    return _Loop(turned, z, np.array([_response(plant, z) for plant in turned]), omega >= speed_rad_s)


def _response(plant: SampledPlant, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    order = len(plant.N)
    gamma = (z - 1.0)[:, np.newaxis, np.newaxis] * np.eye(order)
    return np.asarray(
        (plant.C @ np.linalg.solve(gamma - plant.N, np.broadcast_to(plant.B, (len(z), order, 1))))[:, 0, 0]
    )


def _filter_s(loop: _Loop, k_p: float, k_d: float) -> float:
    """Tf = Td / 10, but no faster than the sampling can filter."""
    return max(k_d / (DERIVATIVE_SHARE * k_p), 2.0 * loop.Ts_s)


def _largest_integral(loop: _Loop, k_p: float, k_d: float, bound: float) -> float:
    """The largest k_i within the bound, 0 where there is none."""

    def holds(k_i: float) -> bool:
        return _peak(loop, k_p, k_i, k_d) <= bound and _radius(loop, k_p, k_i, k_d) < 1.0

    real_zeros = k_p * k_p / (4.0 * k_d)
    low = next((ratio * real_zeros for ratio in _RATIOS if holds(ratio * real_zeros)), 0.0)
    if low in (0.0, real_zeros):
        return low
    high = low * _RATIOS[0] / _RATIOS[1]
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def _sensitivity(loop: _Loop, k_p: float, k_i: float, k_d: float) -> float:
    """The largest |1/(1 + C G)| over frequencies and operating points; above NO_LOOP where a loop is unstable or faster than wished, the
    farther the higher, so that a search comes back from there."""
    largest = _peak(loop, k_p, k_i, k_d)
    if largest > NO_LOOP:
        return largest
    radius = _radius(loop, k_p, k_i, k_d)
    return largest if radius < 1.0 else NO_LOOP * radius


def _peak(loop: _Loop, k_p: float, k_i: float, k_d: float) -> float:
    """The same of loops whose poles nobody looked at."""
    filter_s = _filter_s(loop, k_p, k_d)
    g = lag_gain(filter_s, loop.Ts_s)
    C = k_p + k_i * loop.Ts_s / (loop.z - 1.0) + k_d / filter_s * (1.0 - g * loop.z / (loop.z - 1.0 + g))
    L = loop.G * C
    too_fast = float(np.max(np.abs(L[:, loop.is_fast])))
    return NO_LOOP * too_fast if too_fast >= 1.0 else float(np.max(np.abs(1.0 / (1.0 + L))))


def _radius(loop: _Loop, k_p: float, k_i: float, k_d: float) -> float:
    """The largest |z| of the poles of all closed loops x, I, y_f."""
    filter_s = _filter_s(loop, k_p, k_d)
    g, k_f = lag_gain(filter_s, loop.Ts_s), k_d / filter_s
    order = len(loop.plants[0].N)
    closed = np.zeros((len(loop.plants), order + 2, order + 2))
    for matrix, plant in zip(closed, loop.plants, strict=True):
        feedback = np.concatenate([-(k_p + k_f * (1.0 - g)) * plant.C[0], [1.0, k_f * (1.0 - g)]])
        matrix[:order, :order] = np.eye(order) + plant.N
        matrix[:order] += plant.B @ feedback[np.newaxis]
        matrix[order, :order], matrix[order, order] = -k_i * loop.Ts_s * plant.C[0], 1.0
        matrix[-1, :order], matrix[-1, -1] = g * plant.C[0], 1.0 - g
    return float(np.max(np.abs(np.linalg.eigvals(closed))))
