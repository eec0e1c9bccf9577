"""The frame of every law over any arithmetic: accept inputs, filter references, feed forward; a law's equations do the rest.

Functions, names, and the order of every operation are those of templates/law_frame.c.j2; an arithmetic gives the numbers and the
few decisions. Numbers are `N`: Python floats make a float law, NumPy float32 its exact twin, balls with errors a proof.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from records.loops import Loop
from records.table import LEAST_SCHEDULE_RAD, PLAUSIBLE_V, Polynomial, Table

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
    """What each axis remembers, and the last accepted measurements and references, all in the order of the table's loops."""

    axes: tuple[Any, ...]
    angles_rad: tuple[N, ...]
    references_rad: tuple[N, ...]


@dataclass(frozen=True)
class LawInput(Generic[N]):
    """References and measured angles of one step, in the order of the table's loops."""

    references_rad: tuple[N, ...]
    angles_rad: tuple[N, ...]

    @classmethod
    def of(cls, numbers: Sequence[N]) -> "LawInput[N]":
        """From the references, then the angles, of all loops."""
        count = len(numbers) // 2
        return cls(tuple(numbers[:count]), tuple(numbers[count:]))


def last_accepted(loops: tuple[Loop, ...]) -> tuple[str, ...]:
    """The names in the C of what a state holds besides its axes."""
    return (*(loop.output for loop in loops), *(loop.reference for loop in loops))


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
class ScheduleNumbers(Generic[N]):
    """Which loop's angle the coefficients are of, and its range [rad]."""

    index: int
    min_rad: N
    max_rad: N


@dataclass(frozen=True)
class LawNumbers(Generic[N]):
    """Numbers of all axes, the schedule and its least angle [rad], zero and the plausible feedback voltage [V]."""

    axes: tuple[Any, ...]
    schedule: ScheduleNumbers[N] | None
    least_schedule_rad: N
    zero: N
    plausible_V: N


@dataclass(frozen=True)
class Sample(Generic[N]):
    """What one axis is given in one sample: accepted angle, scheduling angle, its filtered reference, feed-forward."""

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


def range_numbers(table: Table[Any], number: Callable[[float], N]) -> dict[str, Any]:
    """The fields of LawNumbers besides its axes."""
    return {
        "schedule": schedule_numbers(table, number),
        "least_schedule_rad": number(LEAST_SCHEDULE_RAD),
        "zero": number(0.0),
        "plausible_V": number(PLAUSIBLE_V),
    }


def schedule_numbers(table: Table[Any], number: Callable[[float], N]) -> ScheduleNumbers[N] | None:
    """The schedule's numbers; None without one."""
    schedule = table.schedule
    if schedule is None:
        return None
    return ScheduleNumbers(table.index(schedule.axis), number(schedule.min_rad), number(schedule.max_rad))


def schedule_ranges(table: Table[Any]) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ranges of the scheduling angle and of its reference [rad]."""
    schedule, axis = table.schedule, table.scheduled
    if schedule is None or axis is None:
        return (0.0, 0.0), (0.0, 0.0)
    return (schedule.min_rad, schedule.max_rad), (axis.reference_min_rad, axis.reference_max_rad)


def without_vanishing_powers(polynomial: Polynomial) -> Polynomial:
    """The polynomial up to its highest coefficient that is not zero in float32."""
    used = [index for index, coefficient in enumerate(polynomial) if np.float32(coefficient) != 0.0]
    return polynomial[: used[-1] + 1] if used else ()


def polynomial_bound(polynomial: Polynomial, widest: float) -> float:
    """Bound of |polynomial| for |x| <= widest: sum_i |c_i| widest^i."""
    return sum(abs(c) * widest**power for power, c in enumerate(polynomial))


def state_of_words(words: Any, axis_state: Callable[..., Any], loops: int) -> LawState[Any]:
    """A state from its numbers in the order of the C structure, for axes that remember an `axis_state`; `words[i]` is number i."""
    count = len(fields(axis_state))  # type: ignore[arg-type]
    axes = tuple(axis_state(*(words[at + index] for index in range(count))) for at in range(0, loops * count, count))
    angles, references = (
        tuple(words[at + index] for index in range(loops)) for at in (loops * count, loops * (count + 1))
    )
    return LawState(axes, angles, references)


def state_size(axis_state: Callable[..., Any], loops: int) -> int:
    """Numbers of such a state."""
    return loops * (len(fields(axis_state)) + 2)  # type: ignore[arg-type]


def words_from_state(state: LawState[N]) -> Iterator[N]:
    """The numbers of a state in the order of the C structure."""
    for axis in state.axes:
        yield from (getattr(axis, field.name) for field in fields(axis))
    yield from (*state.angles_rad, *state.references_rad)


def law_reset(
    equations: AxisEquations, law: LawNumbers[N], arithmetic: Arithmetic[N], angles_rad: Sequence[N]
) -> LawState[N]:
    """The state at rest at these angles: the reference filters start there, the feedback at zero."""
    accepted_rad = tuple(arithmetic.finite_or(angle_rad, law.zero) for angle_rad in angles_rad)
    schedule_rad = scheduled(law, arithmetic, accepted_rad)
    axes = tuple(
        _at_rest(equations, law, axis, arithmetic, angle_rad, schedule_rad)
        for axis, angle_rad in zip(law.axes, accepted_rad, strict=True)
    )
    return LawState(axes, accepted_rad, tuple(axis.reference_2_rad for axis in axes))


def law_step(
    equations: AxisEquations, law: LawNumbers[N], arithmetic: Arithmetic[N], state: LawState[N], given: LawInput[N]
) -> tuple[LawState[N], tuple[N, ...]]:
    """One sample of all axes: the new state and the limited voltages."""
    angles_rad = _accepted(arithmetic, given.angles_rad, state.angles_rad)
    references_rad = _accepted(arithmetic, given.references_rad, state.references_rad)
    schedule_rad = scheduled(law, arithmetic, angles_rad)
    filtered = [
        prefilter(axis, arithmetic, remembered, reference_rad)
        for axis, remembered, reference_rad in zip(law.axes, state.axes, references_rad, strict=True)
    ]
    region_rad = region(law, filtered)
    feedforwards_V = [polynomial(axis.feedforward_V, region_rad, law.zero) for axis in law.axes]
    stepped = [
        equations.axis_step(law, axis, arithmetic, remembered, Sample(angle_rad, schedule_rad, region_rad, u_ff_V))
        for axis, remembered, angle_rad, u_ff_V in zip(law.axes, filtered, angles_rad, feedforwards_V, strict=True)
    ]
    axes, voltages_V = zip(*stepped, strict=True)
    return LawState(axes, angles_rad, references_rad), voltages_V


def _accepted(arithmetic: Arithmetic[N], values: Sequence[N], last: Sequence[N]) -> tuple[N, ...]:
    return tuple(arithmetic.finite_or(value, before) for value, before in zip(values, last, strict=True))


def scheduled(law: LawNumbers[N], arithmetic: Arithmetic[N], angles_rad: Sequence[N]) -> N:
    """The angle that the coefficients are of: within the schedule's range, zero where next to it, or without a schedule."""
    schedule = law.schedule
    if schedule is None:
        return law.zero
    held_rad = arithmetic.clamp(angles_rad[schedule.index], schedule.min_rad, schedule.max_rad)
    return arithmetic.settle(held_rad, law.least_schedule_rad)


def region(law: LawNumbers[N], filtered: Sequence[Any]) -> Any:
    """The filtered reference of the scheduling angle, which the feed-forward is of; zero without a schedule."""
    return law.zero if law.schedule is None else filtered[law.schedule.index].reference_2_rad


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
