"""The frame of every law over any arithmetic: accept inputs, filter references, feed forward; a law's equations do the rest.

Functions, names, and the order of every operation are those of templates/law_frame.c.j2; an arithmetic gives the numbers and the
few decisions. Numbers are `N`: Python floats make a float law, NumPy float32 its exact twin, balls with errors a proof.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from records.table import LEAST_SCHEDULE_RAD, PLAUSIBLE_V, Polynomial

N = TypeVar("N")


class Arithmetic(Protocol[N]):
    """What the frame asks of an arithmetic beyond + - *; a condition is whatever `choose` of the same arithmetic takes."""

    def finite_or(self, value: N, last: N) -> N:
        """`value` where it is finite, else `last` where that is finite, else zero."""

    def clamp(self, value: N, low: N, high: N) -> N:
        """`value` held within low..high; `value` is no NaN."""

    def saturate(self, value: N, low: N, high: N, safe: N) -> N:
        """`value` held within low..high, `safe` where it is NaN."""

    def settle(self, value: N, least: N) -> N:
        """`value`, or zero where |value| < least."""

    def advanced(self, last: N, step: N, target: N) -> N:
        """`last` + `step`; where that is `last` itself and not `target`, the number next to it towards `target`."""

    def is_plausible(self, value: N, bound: N) -> Any:
        """Condition |value| <= bound; false for NaN."""

    def choose(self, condition: Any, value: N, otherwise: N) -> N:
        """`value` where the condition holds, else `otherwise`."""


@dataclass(frozen=True)
class LawState(Generic[N]):
    """Both axes and the last accepted measurements and references."""

    elevation: Any
    azimuth: Any
    psi_rad: N
    phi_rad: N
    psi_ref_rad: N
    phi_ref_rad: N


@dataclass(frozen=True)
class LawInput(Generic[N]):
    """References and measured angles of one step."""

    psi_ref_rad: N
    phi_ref_rad: N
    psi_rad: N
    phi_rad: N


@dataclass(frozen=True)
class LawOutput(Generic[N]):
    """Voltages of one step, within their limits."""

    u_M_V: N
    u_T_V: N


LAST_ACCEPTED_FIELDS = tuple(field.name for field in fields(LawState))[2:]


@dataclass(frozen=True)
class AxisFrame(Generic[N]):
    """The frame's numbers of one axis; a law adds its own."""

    feedforward_V: tuple[N, ...]
    prefilter_gain: N | None
    u_min_V: N
    u_max_V: N
    u_safe_V: N
    reference_min_rad: N
    reference_max_rad: N


@dataclass(frozen=True)
class LawNumbers(Generic[N]):
    """Numbers of both axes, the scheduling range and its least angle [rad], zero and the plausible feedback voltage [V]."""

    elevation: Any
    azimuth: Any
    psi_min_rad: N
    psi_max_rad: N
    least_schedule_rad: N
    zero: N
    plausible_V: N


@dataclass(frozen=True)
class Sample(Generic[N]):
    """What one axis is given in one sample: accepted angle, scheduling elevation, filtered elevation reference, feed-forward."""

    angle_rad: N
    schedule_rad: N
    region_rad: N
    u_ff_V: N


class AxisEquations(Protocol):
    """A law's own part. `AxisState` is a frozen dataclass of numbers that begins with reference_1_rad, reference_2_rad."""

    @property
    def AxisState(self) -> Callable[..., Any]:
        """The record of what one axis remembers."""

    def axis_rest(
        self, law: Any, axis: Any, arithmetic: Any, reference_rad: Any, angle_rad: Any, schedule_rad: Any
    ) -> Any:
        """The axis' state at rest at this angle; `reference_rad` is the angle within the reference's range."""

    def axis_step(self, law: Any, axis: Any, arithmetic: Any, state: Any, sample: Any) -> tuple[Any, Any]:
        """From the state with its reference filtered to the state after the sample, and the limited voltage."""


def frame_numbers(axis: Any, sample_period_s: float, number: Callable[[float], N]) -> dict[str, Any]:
    """The fields of AxisFrame for one axis of a table, each number made by `number`."""
    unfiltered = axis.prefilter_time_constant_s == 0.0
    return {
        "feedforward_V": tuple(number(c) for c in without_vanishing_powers(axis.feedforward_V)),
        "prefilter_gain": None if unfiltered else number(axis.prefilter_gain(sample_period_s)),
        "u_min_V": number(axis.u_min_V),
        "u_max_V": number(axis.u_max_V),
        "u_safe_V": number(axis.u_safe_V),
        "reference_min_rad": number(axis.reference_min_rad),
        "reference_max_rad": number(axis.reference_max_rad),
    }


def range_numbers(table: Any, number: Callable[[float], N]) -> dict[str, Any]:
    """The fields of LawNumbers besides its axes."""
    return {
        "psi_min_rad": number(table.psi_min_rad),
        "psi_max_rad": number(table.psi_max_rad),
        "least_schedule_rad": number(LEAST_SCHEDULE_RAD),
        "zero": number(0.0),
        "plausible_V": number(PLAUSIBLE_V),
    }


def without_vanishing_powers(polynomial: Polynomial) -> Polynomial:
    """The polynomial up to its highest coefficient that is not zero in float32."""
    used = [index for index, coefficient in enumerate(polynomial) if np.float32(coefficient) != 0.0]
    return polynomial[: used[-1] + 1] if used else ()


def polynomial_bound(polynomial: Polynomial, widest: float) -> float:
    """Bound of |polynomial| for |x| <= widest: sum_i |c_i| widest^i."""
    return sum(abs(c) * widest**power for power, c in enumerate(polynomial))


def state_of_words(words: Any, axis_state: Callable[..., Any]) -> LawState[Any]:
    """A state from its numbers in the order of the C structure, for axes that remember an `axis_state`; `words[i]` is number i."""
    count = len(fields(axis_state))  # type: ignore[arg-type]
    return LawState(
        axis_state(*(words[index] for index in range(count))),
        axis_state(*(words[index] for index in range(count, 2 * count))),
        *(words[index] for index in range(2 * count, 2 * count + len(LAST_ACCEPTED_FIELDS))),
    )


def words_from_state(state: LawState[N]) -> Iterator[N]:
    """The numbers of a state in the order of the C structure."""
    for axis in (state.elevation, state.azimuth):
        yield from (getattr(axis, field.name) for field in fields(axis))
    yield from (getattr(state, name) for name in LAST_ACCEPTED_FIELDS)


def law_reset(
    equations: AxisEquations, law: LawNumbers[N], arithmetic: Arithmetic[N], psi_rad: N, phi_rad: N
) -> LawState[N]:
    """The state at rest at these angles: the reference filters start there, the feedback at zero."""
    psi_rad = arithmetic.finite_or(psi_rad, law.zero)
    phi_rad = arithmetic.finite_or(phi_rad, law.zero)
    schedule_rad = scheduled(law, arithmetic, psi_rad)
    elevation = _at_rest(equations, law, law.elevation, arithmetic, psi_rad, schedule_rad)
    azimuth = _at_rest(equations, law, law.azimuth, arithmetic, phi_rad, schedule_rad)
    return LawState(elevation, azimuth, psi_rad, phi_rad, elevation.reference_2_rad, azimuth.reference_2_rad)


def law_step(
    equations: AxisEquations, law: LawNumbers[N], arithmetic: Arithmetic[N], state: LawState[N], given: LawInput[N]
) -> tuple[LawState[N], LawOutput[N]]:
    """One sample of both axes: the new state and the limited voltages."""
    psi_rad = arithmetic.finite_or(given.psi_rad, state.psi_rad)
    phi_rad = arithmetic.finite_or(given.phi_rad, state.phi_rad)
    psi_ref_rad = arithmetic.finite_or(given.psi_ref_rad, state.psi_ref_rad)
    phi_ref_rad = arithmetic.finite_or(given.phi_ref_rad, state.phi_ref_rad)
    schedule_rad = scheduled(law, arithmetic, psi_rad)

    elevation = prefilter(law.elevation, arithmetic, state.elevation, psi_ref_rad)
    azimuth = prefilter(law.azimuth, arithmetic, state.azimuth, phi_ref_rad)
    region_rad = elevation.reference_2_rad
    u_M_ff_V = polynomial(law.elevation.feedforward_V, region_rad, law.zero)
    u_T_ff_V = polynomial(law.azimuth.feedforward_V, region_rad, law.zero)

    step = equations.axis_step
    psi = Sample(psi_rad, schedule_rad, region_rad, u_M_ff_V)
    phi = Sample(phi_rad, schedule_rad, region_rad, u_T_ff_V)
    elevation, u_M_V = step(law, law.elevation, arithmetic, elevation, psi)
    azimuth, u_T_V = step(law, law.azimuth, arithmetic, azimuth, phi)
    return LawState(elevation, azimuth, psi_rad, phi_rad, psi_ref_rad, phi_ref_rad), LawOutput(u_M_V, u_T_V)


def scheduled(law: LawNumbers[N], arithmetic: Arithmetic[N], psi_rad: N) -> N:
    """The elevation that the coefficients are of: within the schedule's range, zero where next to it."""
    return arithmetic.settle(arithmetic.clamp(psi_rad, law.psi_min_rad, law.psi_max_rad), law.least_schedule_rad)


def prefilter(axis: AxisFrame[N], arithmetic: Arithmetic[N], state: Any, reference_rad: N) -> Any:
    """1/(T s + 1)^2 as two one-poles that arrive; both stay within the reference's range, so a broken state heals at once."""
    low_rad, high_rad = axis.reference_min_rad, axis.reference_max_rad
    target_rad: Any = arithmetic.clamp(reference_rad, low_rad, high_rad)
    if axis.prefilter_gain is None:
        return replace(state, reference_1_rad=target_rad, reference_2_rad=target_rad)
    first_rad: Any = state.reference_1_rad
    first_rad = arithmetic.advanced(first_rad, axis.prefilter_gain * (target_rad - first_rad), target_rad)
    first_rad = arithmetic.saturate(first_rad, low_rad, high_rad, target_rad)
    second_rad: Any = state.reference_2_rad
    second_rad = arithmetic.advanced(second_rad, axis.prefilter_gain * (first_rad - second_rad), first_rad)
    second_rad = arithmetic.saturate(second_rad, low_rad, high_rad, target_rad)
    return replace(state, reference_1_rad=first_rad, reference_2_rad=second_rad)


def polynomial(coefficients: tuple[N, ...], x: N, zero: N) -> Any:
    """((c_n x + ...) x + c_1) x + c_0 by Horner; zero for no coefficients."""
    if not coefficients:
        return zero
    value: Any = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        value = value * x + coefficient
    return value


def _at_rest(
    equations: AxisEquations,
    law: LawNumbers[N],
    axis: AxisFrame[N],
    arithmetic: Arithmetic[N],
    angle_rad: N,
    schedule_rad: N,
) -> Any:
    reference_rad = arithmetic.clamp(angle_rad, axis.reference_min_rad, axis.reference_max_rad)
    return equations.axis_rest(law, axis, arithmetic, reference_rad, angle_rad, schedule_rad)
