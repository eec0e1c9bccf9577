"""The ranges of states and inputs for which the rounding bound is proved."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from codegen.law_equations import axis_state
from codegen.law_frame import LawInput, LawState
from codegen.scales import FASTEST_RAD_S
from records.table import AxisLaw, ControllerTable

Range = tuple[float, float]

# The law's own rounding may carry a difference of two numbers this little (relatively) beyond the difference of their ranges.
_SLACK = 1.0 + 1e-5


@dataclass(frozen=True)
class LawRanges:
    """A range for every number of state and input, and for each axis' error with its differences, one more than are remembered."""

    state: LawState[Range]
    given: LawInput[Range]
    errors_rad: tuple[tuple[Range, ...], ...]


@dataclass(frozen=True)
class Motion:
    """What is assumed of each loop's axis: hard stop, and how fast its output may move from sample to sample, a second."""

    limits_rad: tuple[float, ...]
    rates_rad_s: tuple[float, ...]


CE150_MOTION = Motion((0.7854, 2.2690), (FASTEST_RAD_S, FASTEST_RAD_S))


def declared_ranges(table: ControllerTable, motion: Motion) -> LawRanges:
    """Ranges of flight: angles within the stops and moving no faster than the rates, both as the encoders show them, references
    within their limits, filters within the references' range, and saturation by no more than the span of the limits:

        e in x_2 - angle                    |delta e| <= rate Ts + step + b span(x)   |delta^2 e| <= 2 |delta e|
        s = limited u - u_ff                |delta s| <= span(s)                      |delta^2 s| <= 2 |delta s|, and so on
        |w| <= span of the limits           |delta w| <= 2 |w|                        |delta^2 w| <= 2 |delta w|
        v = s + w

    A step that starts outside, after a harder saturation say, is not covered.
    """
    limits_rad = [limit + axis.resolution_rad for limit, axis in zip(motion.limits_rad, table.axes, strict=True)]
    errors_rad = tuple(
        _error_ranges(table, axis, limit_rad, rate_rad_s)
        for axis, limit_rad, rate_rad_s in zip(table.axes, limits_rad, motion.rates_rad_s, strict=True)
    )
    axes = tuple(_axis_ranges(table, axis, ranges) for axis, ranges in zip(table.axes, errors_rad, strict=True))
    angles_rad = tuple(_around_zero(limit_rad) for limit_rad in limits_rad)
    references_rad = tuple(_reference(axis) for axis in table.axes)
    return LawRanges(LawState(axes, angles_rad, references_rad), LawInput(references_rad, angles_rad), errors_rad)


def _error_ranges(table: ControllerTable, axis: AxisLaw, limit_rad: float, rate_rad_s: float) -> tuple[Range, ...]:
    low_rad, high_rad = _reference(axis)
    gain = axis.prefilter_gain(table.sample_period_s)
    measured_move_rad = rate_rad_s * table.sample_period_s + axis.resolution_rad
    move_rad = _SLACK * (measured_move_rad + gain * (high_rad - low_rad))
    differences = (_around_zero(2.0**power * move_rad) for power in range(table.order))
    return (_SLACK * (low_rad - limit_rad), _SLACK * (high_rad + limit_rad)), *differences


def _axis_ranges(table: ControllerTable, axis: AxisLaw, error_rad: tuple[Range, ...]) -> Any:
    record = axis_state(table.order)
    region = table.scheduled
    region_rad = np.linspace(*((0.0, 0.0) if region is None else _reference(region)), 201)
    u_ff_V = np.polynomial.polynomial.polyval(region_rad, axis.feedforward_V)
    span_V = _SLACK * (axis.u_max_V - axis.u_min_V)
    slack_V = (_SLACK - 1.0) * span_V
    s_V = (axis.u_min_V - float(u_ff_V.max()) - slack_V, axis.u_max_V - float(u_ff_V.min()) + slack_V)
    s_span_V = _SLACK * (s_V[1] - s_V[0])
    return record(
        reference_1_rad=_reference(axis),
        reference_2_rad=_reference(axis),
        v_V=(s_V[0] - span_V, s_V[1] + span_V),
        **dict(zip(record.E, error_rad, strict=False)),
        **_moving(record.S, s_V, s_span_V),
        **_moving(record.W, _around_zero(span_V), _SLACK * 2.0 * span_V),
    )


def _moving(names: tuple[str, ...], value: Range, move: float) -> dict[str, Range]:
    """A number and its differences, of which the first stays within +-move and each further one within twice the one before."""
    bounds = (move * 2.0**power * (_SLACK if power > 1 else 1.0) for power in range(len(names) - 1))
    return {names[0]: value, **dict(zip(names[1:], map(_around_zero, bounds), strict=True))}


def _reference(axis: AxisLaw) -> Range:
    """The reference's range as the law holds it, with limits rounded to float32."""
    return float(np.float32(axis.reference_min_rad)), float(np.float32(axis.reference_max_rad))


def _around_zero(bound: float) -> Range:
    return -bound, bound
