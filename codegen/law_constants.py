"""The numbers of the law, taken from a controller table into any arithmetic."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from records.errors import BadInput
from records.table import LEAST_SCHEDULE_RAD, PLAUSIBLE_V, AxisLaw, ControllerTable, Polynomial

N = TypeVar("N")
M = TypeVar("M")

# No shaft turns further than this against its reference: the widest error that the check of PLAUSIBLE_V assumes.
WIDEST_ERROR_RAD = 2.0 * math.pi


@dataclass(frozen=True)
class AxisConstants(Generic[N]):
    """Numbers of one axis; polynomials hold ascending coefficients, () where the polynomial is zero for every Psi."""

    q_V_rad: tuple[tuple[N, ...], ...]
    p: tuple[tuple[N, ...], ...]
    a: tuple[tuple[N, ...], ...]
    feedforward_V: tuple[N, ...]
    prefilter_gain: N | None
    u_min_V: N
    u_max_V: N
    u_safe_V: N
    reference_min_rad: N
    reference_max_rad: N


@dataclass(frozen=True)
class LawConstants(Generic[N]):
    """Numbers of both axes, the scheduling range and its least angle [rad], zero and the plausible feedback voltage [V]."""

    elevation: AxisConstants[N]
    azimuth: AxisConstants[N]
    psi_min_rad: N
    psi_max_rad: N
    least_schedule_rad: N
    zero: N
    plausible_V: N


def law_constants(table: ControllerTable, number: Callable[[float], N]) -> LawConstants[N]:
    """The law's numbers, each made by `number`; terms that are zero in float32 for every Psi are left out.

    Raises BadInput for a table whose law could not run: a sample period that is not whole microseconds, no feedback at all,
    or voltages beyond PLAUSIBLE_V (so beyond float32's range as well) within reach.
    """
    _refuse_unusable(table)
    return LawConstants(
        elevation=_axis_constants(table.elevation, table.sample_period_s, number),
        azimuth=_axis_constants(table.azimuth, table.sample_period_s, number),
        psi_min_rad=number(table.psi_min_rad),
        psi_max_rad=number(table.psi_max_rad),
        least_schedule_rad=number(LEAST_SCHEDULE_RAD),
        zero=number(0.0),
        plausible_V=number(PLAUSIBLE_V),
    )


def _axis_constants(axis: AxisLaw, sample_period_s: float, number: Callable[[float], N]) -> AxisConstants[N]:
    def numbers(polynomial: Polynomial) -> tuple[N, ...]:
        return tuple(number(coefficient) for coefficient in without_vanishing_powers(polynomial))

    return AxisConstants(
        q_V_rad=tuple(numbers(polynomial) for polynomial in axis.q_V_rad),
        p=tuple(numbers(polynomial) for polynomial in axis.p),
        a=tuple(numbers((coefficient,)) for coefficient in axis.a),
        feedforward_V=numbers(axis.feedforward_V),
        prefilter_gain=None if axis.prefilter_time_constant_s == 0.0 else number(axis.prefilter_gain(sample_period_s)),
        u_min_V=number(axis.u_min_V),
        u_max_V=number(axis.u_max_V),
        u_safe_V=number(axis.u_safe_V),
        reference_min_rad=number(axis.reference_min_rad),
        reference_max_rad=number(axis.reference_max_rad),
    )


def without_vanishing_powers(polynomial: Polynomial) -> Polynomial:
    """The polynomial up to its highest coefficient that is not zero in float32."""
    used = [index for index, coefficient in enumerate(polynomial) if np.float32(coefficient) != 0.0]
    return polynomial[: used[-1] + 1] if used else ()


def _refuse_unusable(table: ControllerTable) -> None:
    period_us = table.sample_period_s * 1e6
    if abs(period_us - round(period_us)) > 1e-6 * period_us or not 1 <= round(period_us) < 2**32:
        raise BadInput(
            "sample_period_s",
            "controller table",
            f"{table.sample_period_s!r} s",
            "whole microseconds, as the board's timer counts them",
            "choose another sample period and design the table again",
        )
    for name, axis in (("elevation", table.elevation), ("azimuth", table.azimuth)):
        psi_rad = max(abs(table.psi_min_rad), abs(table.psi_max_rad))
        gains = [_largest(polynomial, psi_rad) for polynomial in axis.q_V_rad]
        if not any(gains):
            raise _unusable(name, "every q is zero", "an axis with feedback")
        # delta^i of an error within +-W reaches 2^i W; s and w stay within the span of the limits.
        span_V = axis.u_max_V - axis.u_min_V
        feedback_V = sum(gain * 2.0**power * WIDEST_ERROR_RAD for power, gain in enumerate(gains))
        recursion_V = sum(_largest(p, psi_rad) + abs(a) for p, a in zip(axis.p, axis.a, strict=True)) * 4.0 * span_V
        reference_rad = max(abs(table.elevation.reference_min_rad), abs(table.elevation.reference_max_rad))
        reached_V = feedback_V + recursion_V + span_V + _largest(axis.feedforward_V, reference_rad)
        if not reached_V < PLAUSIBLE_V:
            raise _unusable(name, f"voltages of up to {reached_V:.3g} V", f"less than {PLAUSIBLE_V:g} V")


def _largest(polynomial: Polynomial, angle_rad: float) -> float:
    """Bound of |polynomial| up to this angle."""
    return sum(abs(coefficient) * angle_rad**power for power, coefficient in enumerate(polynomial))


def _unusable(axis: str, got: str, expected: str) -> BadInput:
    return BadInput("controller table", f"axis {axis}", got, expected, "choose other poles and design the table again")
