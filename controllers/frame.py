"""The frame of a law over any arithmetic: accept inputs, filter references, feed forward; a controller's equations do the rest.

Functions, names and the order of every operation are those of codegen/templates/law_frame.c.j2. Numbers are `N`: Python floats make
the float law, NumPy float32 its exact twin.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from codegen.law_constants import without_vanishing_powers
from codegen.law_equations import Arithmetic, LawInput, LawOutput, LawState, polynomial, prefilter
from records.law_table import AxisTable, LawTable
from records.table import LEAST_SCHEDULE_RAD

N = TypeVar("N")


class Decisions(Arithmetic[N], Protocol[N]):
    """What controllers ask of an arithmetic beyond what the scheduled law asks."""

    def is_less(self, value: N, other: N) -> Any:
        """Condition value < other; neither is NaN."""


@dataclass(frozen=True)
class AxisNumbers(Generic[N]):
    """Numbers of one axis; `gains` is the controller's record with every number made by the arithmetic."""

    gains: Any
    feedforward_V: tuple[N, ...]
    prefilter_gain: N | None
    u_min_V: N
    u_max_V: N
    u_safe_V: N
    reference_min_rad: N
    reference_max_rad: N


@dataclass(frozen=True)
class Numbers(Generic[N]):
    """Numbers of both axes, the scheduling range and its least angle [rad], zero."""

    elevation: AxisNumbers[N]
    azimuth: AxisNumbers[N]
    psi_min_rad: N
    psi_max_rad: N
    least_schedule_rad: N
    zero: N


@dataclass(frozen=True)
class Sample(Generic[N]):
    """What one axis is given in one sample: accepted angle, scheduling elevation, filtered elevation reference, feed-forward."""

    angle_rad: N
    schedule_rad: N
    region_rad: N
    u_ff_V: N


class AxisEquations(Protocol):
    """A controller's own part. `AxisState` is a frozen dataclass of numbers that begins with reference_1_rad, reference_2_rad."""

    @property
    def AxisState(self) -> Callable[..., Any]: ...

    def axis_rest(self, axis: Any, arithmetic: Any, zero: Any, reference_rad: Any, angle_rad: Any) -> Any:
        """The axis' state at rest at this angle; `reference_rad` is the angle within the reference's range."""

    def axis_step(self, axis: Any, arithmetic: Any, zero: Any, state: Any, sample: Any) -> tuple[Any, Any]:
        """From the state with its reference filtered to the state after the sample, and the limited voltage."""


def numbers_of(table: LawTable[Any], number: Callable[[float], N]) -> Numbers[N]:
    """All numbers of a table, each made by `number`."""
    return Numbers(
        elevation=_axis(table.elevation, table.sample_period_s, number),
        azimuth=_axis(table.azimuth, table.sample_period_s, number),
        psi_min_rad=number(table.psi_min_rad),
        psi_max_rad=number(table.psi_max_rad),
        least_schedule_rad=number(LEAST_SCHEDULE_RAD),
        zero=number(0.0),
    )


def _axis(axis: AxisTable[Any], sample_period_s: float, number: Callable[[float], N]) -> AxisNumbers[N]:
    unfiltered = axis.prefilter_time_constant_s == 0.0
    return AxisNumbers(
        gains=_each(axis.gains, number),
        feedforward_V=tuple(number(c) for c in without_vanishing_powers(axis.feedforward_V)),
        prefilter_gain=None if unfiltered else number(axis.prefilter_gain(sample_period_s)),
        u_min_V=number(axis.u_min_V),
        u_max_V=number(axis.u_max_V),
        u_safe_V=number(axis.u_safe_V),
        reference_min_rad=number(axis.reference_min_rad),
        reference_max_rad=number(axis.reference_max_rad),
    )


def _each(entry: Any, number: Callable[[float], Any]) -> Any:
    """The same record, tuple or number with `number` applied to every float; whole numbers are sizes and stay."""
    if is_dataclass(entry) and not isinstance(entry, type):
        return replace(entry, **{field.name: _each(getattr(entry, field.name), number) for field in fields(entry)})
    if isinstance(entry, tuple):
        return tuple(_each(value, number) for value in entry)
    return number(entry) if isinstance(entry, float) else entry


def law_reset(
    equations: AxisEquations, law: Numbers[N], arithmetic: Arithmetic[N], psi_rad: N, phi_rad: N
) -> LawState[Any]:
    """The state at rest at these angles: the reference filters start there."""
    psi_rad = arithmetic.finite_or(psi_rad, law.zero)
    phi_rad = arithmetic.finite_or(phi_rad, law.zero)
    elevation = _at_rest(equations, law, law.elevation, arithmetic, psi_rad)
    azimuth = _at_rest(equations, law, law.azimuth, arithmetic, phi_rad)
    return LawState(elevation, azimuth, psi_rad, phi_rad, elevation.reference_2_rad, azimuth.reference_2_rad)


def law_step(
    equations: AxisEquations, law: Numbers[N], arithmetic: Arithmetic[N], state: LawState[Any], given: LawInput[N]
) -> tuple[LawState[Any], LawOutput[N]]:
    """One sample of both axes: the new state and the limited voltages."""
    psi_rad = arithmetic.finite_or(given.psi_rad, state.psi_rad)
    phi_rad = arithmetic.finite_or(given.phi_rad, state.phi_rad)
    psi_ref_rad = arithmetic.finite_or(given.psi_ref_rad, state.psi_ref_rad)
    phi_ref_rad = arithmetic.finite_or(given.phi_ref_rad, state.phi_ref_rad)
    schedule_rad = arithmetic.settle(
        arithmetic.clamp(psi_rad, law.psi_min_rad, law.psi_max_rad), law.least_schedule_rad
    )

    filtered: Any = prefilter  # takes any axis with a filter's gain and a range
    elevation = filtered(law.elevation, arithmetic, state.elevation, psi_ref_rad)
    azimuth = filtered(law.azimuth, arithmetic, state.azimuth, phi_ref_rad)
    region_rad = elevation.reference_2_rad
    u_M_ff_V = polynomial(law.elevation.feedforward_V, elevation.reference_2_rad, law.zero)
    u_T_ff_V = polynomial(law.azimuth.feedforward_V, elevation.reference_2_rad, law.zero)

    step = equations.axis_step
    elevation, u_M_V = step(
        law.elevation, arithmetic, law.zero, elevation, Sample(psi_rad, schedule_rad, region_rad, u_M_ff_V)
    )
    azimuth, u_T_V = step(
        law.azimuth, arithmetic, law.zero, azimuth, Sample(phi_rad, schedule_rad, region_rad, u_T_ff_V)
    )
    return LawState(elevation, azimuth, psi_rad, phi_rad, psi_ref_rad, phi_ref_rad), LawOutput(u_M_V, u_T_V)


def _at_rest(
    equations: AxisEquations, law: Numbers[N], axis: AxisNumbers[N], arithmetic: Arithmetic[N], angle_rad: N
) -> Any:
    reference_rad = arithmetic.clamp(angle_rad, axis.reference_min_rad, axis.reference_max_rad)
    return equations.axis_rest(axis, arithmetic, law.zero, reference_rad, angle_rad)


def float32_polynomial(coefficients: tuple[float, ...]) -> tuple[float, ...]:
    """The polynomial as C stores it: never empty, so that its array has a size."""
    used = without_vanishing_powers(coefficients)
    return tuple(float(np.float32(value)) for value in used) or (0.0,)
