"""The numbers of the law, taken from a controller table into any arithmetic."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from codegen.law_frame import (
    AxisFrame,
    LawNumbers,
    frame_numbers,
    polynomial_bound,
    range_numbers,
    without_vanishing_powers,
)
from codegen.scales import widest_error
from records.errors import BadInput
from records.loops import Loop
from records.table import PLAUSIBLE_V, AxisLaw, ControllerTable, Polynomial
from records.text.units import unit_of

N = TypeVar("N")
M = TypeVar("M")


@dataclass(frozen=True)
class AxisConstants(AxisFrame[N]):
    """Numbers of one axis; polynomials hold ascending coefficients, () where the polynomial is zero for every Psi."""

    q_V_rad: tuple[tuple[N, ...], ...]
    p: tuple[tuple[N, ...], ...]
    a: tuple[tuple[N, ...], ...]


@dataclass(frozen=True)
class LawConstants(LawNumbers[N]):
    """Numbers of all axes of the scheduled law, and the most states of any."""

    order: int


def law_constants(table: ControllerTable, number: Callable[[float], N]) -> LawConstants[N]:
    """The law's numbers, each made by `number`; terms that are zero in float32 for every Psi are left out.

    Raises BadInput for a table whose law could not run: a sample period that is not whole microseconds, no feedback at all,
    or voltages beyond PLAUSIBLE_V (so beyond float32's range as well) within reach.
    """
    _refuse_unusable(table)
    axes = tuple(_axis_constants(axis, table.sample_period_s, number) for axis in table.axes)
    return LawConstants(axes=axes, order=table.order, **range_numbers(table, number))


def _axis_constants(axis: AxisLaw, sample_period_s: float, number: Callable[[float], N]) -> AxisConstants[N]:
    def numbers(polynomial: Polynomial) -> tuple[N, ...]:
        return tuple(number(coefficient) for coefficient in without_vanishing_powers(polynomial))

    return AxisConstants(
        q_V_rad=tuple(numbers(polynomial) for polynomial in axis.q_V_rad),
        p=tuple(numbers(polynomial) for polynomial in axis.p),
        a=tuple(numbers((coefficient,)) for coefficient in axis.a),
        **frame_numbers(axis, sample_period_s, number),
    )


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
    for loop, axis in zip(table.loops, table.axes, strict=True):
        _refuse_unusable_axis(table, loop, axis)


def _refuse_unusable_axis(table: ControllerTable, loop: Loop, axis: AxisLaw) -> None:
    name = loop.axis
    polynomials = (*axis.q_V_rad, *axis.p, axis.feedforward_V)
    if table.schedule is None and any(len(without_vanishing_powers(row)) > 1 for row in polynomials):
        raise _unusable(name, "coefficients that vary without a schedule", "constants, or a scheduling angle")
    psi_rad = table.widest_schedule_rad
    gains = [polynomial_bound(polynomial, psi_rad) for polynomial in axis.q_V_rad]
    if not any(gains):
        raise _unusable(name, "every q is zero", "an axis with feedback")
    # delta^i of an error within +-W reaches 2^i W; s and w stay within the span of the limits.
    span_V = axis.u_max_V - axis.u_min_V
    feedback_V = sum(gain * 2.0**power * widest_error(loop, axis) for power, gain in enumerate(gains))
    recursion = sum(polynomial_bound(p, psi_rad) * 2.0**power for power, p in enumerate(axis.p))
    recursion_V = (recursion + 2.0 ** (axis.order - 1) * sum(map(abs, axis.a))) * span_V
    reached_V = feedback_V + recursion_V + span_V + polynomial_bound(axis.feedforward_V, widest_region_rad(table))
    if not reached_V < PLAUSIBLE_V:
        unit = unit_of(loop.input)
        raise _unusable(name, f"commands of up to {reached_V:.3g} {unit}", f"less than {PLAUSIBLE_V:g} {unit}")


def widest_region_rad(table: ControllerTable) -> float:
    """The largest reference of the scheduling angle, which the feed-forward is of; 0 without a schedule."""
    axis = table.scheduled
    return 0.0 if axis is None else max(abs(axis.reference_min_rad), abs(axis.reference_max_rad))


def _unusable(axis: str, got: str, expected: str) -> BadInput:
    return BadInput("controller table", f"axis {axis}", got, expected, "choose other poles and design the table again")
