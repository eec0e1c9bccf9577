"""The schedule: controller coefficients and feed-forward voltages as polynomials in the elevation.

All q_i are fitted over the same points with the same degree and weights, and all p_i. Least squares is linear, so sums of fits are
fits of sums: P(1) = 0 and the small Q(1), which decide the slow poles, survive although single coefficients are off by far more.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial as Fitted
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from design.direct_form import DeltaForm, to_direct
from records.table import AxisLaw, Polynomial, short

Array = NDArray[np.float64]

NOISE = 1e-11
# Below this sample period [s] the last q, q_3 of three states, is one number for all elevations. Encoder steps then come as close as the
# three samples of a third difference, and a q_3 that changes from step to step rectifies them: at 1 ms u_M of the CE150 drifts by 1 V in
# 0.1 s at 33 deg/s and the flight of `make run` leaves its references by 25 deg, at 2 ms it is 0.1 deg further off on the average, at
# 5 ms nothing is seen.
CONSTANT_Q3_BELOW_S = 2.5e-3
COEFFICIENT_DIGITS = 8  # float32 holds 7
# A constant p_i has few digits (records.table.SHORT_BITS) where these move its distance from 1 by this share at most, else all. P is
# delta^n where p_1, p_2 .. are 1, and that distance, which falls with the sample period to the power n, places the slow poles: rounding
# 1 - p_1 of the CE150 costs 0.04 % at 10 ms, 28 % at 1 ms, and at 0.5 ms it is all gone and the loop unstable.
ROUNDED_SHARE = 0.01


@dataclass(frozen=True)
class Degrees:
    """Degrees of the polynomials in Psi that q and p become."""

    q: int
    p: int


@dataclass(frozen=True)
class Schedule:
    """The feedback of one axis in delta form: n + 1 polynomials q [V/rad], n or n + 1 p in Psi [rad], ascending powers."""

    q: tuple[Polynomial, ...]
    p: tuple[Polynomial, ...]


@dataclass(frozen=True)
class FitError:
    """Largest distance of fit and design over the operating points, relative to the largest coefficient of its polynomial.

    `q` and `p` are of the delta form, `direct_q` and `direct_p` of eq (22).
    """

    q: float
    p: float
    direct_q: float
    direct_p: float


def fit(psi_rad: Array, values: Array, degree: int) -> Polynomial:
    """Least squares polynomial through values (points,), ascending powers of Psi [rad], `degree` + 1 of them.

    A term that stays below NOISE of the largest value over the whole range is rounding, not plant, and becomes exactly 0: an even
    function of Psi gets an even polynomial.
    """
    coefficients = np.zeros(degree + 1)
    fitted = Fitted.fit(psi_rad, values, degree).convert().coef
    coefficients[: len(fitted)] = fitted
    contributions = np.abs(coefficients) * np.max(np.abs(psi_rad)) ** np.arange(degree + 1)
    noise = contributions <= NOISE * np.max(np.abs(values))
    return tuple(float(c) for c in np.where(noise, 0.0, coefficients))


def stored_fit(psi_rad: Array, values: Array, degree: int) -> Polynomial:
    """The same fit of values (points,) as a table holds it, to COEFFICIENT_DIGITS digits of the largest coefficient.

    Beyond, processors round differently, and one design shall have one digest on all of them.
    """
    coefficients = fit(psi_rad, values, degree)
    largest = max(map(abs, coefficients))
    places = COEFFICIENT_DIGITS - 1 - math.floor(math.log10(largest)) if largest > 0.0 else 0
    return tuple(round(c, places) + 0.0 for c in coefficients)


def fit_schedule(psi_rad: Array, designs: Sequence[DeltaForm], degrees: Degrees, sample_period_s: float) -> Schedule:
    """Fit the coefficients of the designs (points,) with equal weights; the last q is a constant below CONSTANT_Q3_BELOW_S."""
    q, p = np.array([design.q for design in designs]), np.array([design.p for design in designs])
    fitted = [_kept(psi_rad, column, degrees.q) for column in q.T]
    if sample_period_s < CONSTANT_Q3_BELOW_S:
        fitted[-1] = _kept(psi_rad, q[:, -1], 0) + (0.0,) * degrees.q
    return Schedule(q=tuple(fitted), p=tuple(_kept(psi_rad, column, degrees.p, 1.0) for column in p.T))


def _kept(psi_rad: Array, values: Array, degree: int, origin: float = 0.0) -> Polynomial:
    """The stored fit, a constant as a short number where its distance from `origin`, which is what matters, allows that."""
    fitted = stored_fit(psi_rad, values, degree)
    rounded = short(fitted[0])
    is_kept = abs(rounded - fitted[0]) <= ROUNDED_SHARE * abs(fitted[0] - origin)
    return (rounded,) if degree == 0 and is_kept else fitted


def schedule_of(law: AxisLaw) -> Schedule:
    """The schedule that a table holds."""
    return Schedule(law.q_V_rad, law.p)


def evaluate(schedule: Schedule, psi_rad: float) -> DeltaForm:
    """The controller at one elevation."""
    return DeltaForm(
        q=np.array([polyval(psi_rad, row) for row in schedule.q]),
        p=np.array([polyval(psi_rad, row) for row in schedule.p]),
    )


def fit_error(psi_rad: Array, designs: Sequence[DeltaForm], schedule: Schedule) -> FitError:
    """How far the schedule is from the designs it was fitted to, at psi_rad (points,)."""
    fitted = [evaluate(schedule, float(psi)) for psi in psi_rad]
    wanted_direct, fitted_direct = [to_direct(d) for d in designs], [to_direct(d) for d in fitted]
    return FitError(
        q=_relative([d.q for d in designs], [d.q for d in fitted]),
        p=_relative([d.p for d in designs], [d.p for d in fitted]),
        direct_q=_relative([d.q for d in wanted_direct], [d.q for d in fitted_direct]),
        direct_p=_relative([d.p for d in wanted_direct], [d.p for d in fitted_direct]),
    )


def _relative(wanted: Sequence[Array], found: Sequence[Array]) -> float:
    largest = np.max(np.abs(np.array(wanted)))
    missed = np.max(np.abs(np.array(found) - np.array(wanted)))
    return float(missed / largest) if largest else 0.0  # of one state, P is 1 - z^-1 and nothing is fitted
