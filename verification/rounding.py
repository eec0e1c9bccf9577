"""A proved bound on what one step of the float32 law can differ from the same step in real numbers.

Both laws start from the same state and inputs, float32 numbers within declared ranges (ranges.py); the real law has the table's
own numbers, the float32 law those rounded. The law's equations are run once on numbers that carry an enclosure of the real value
and an affine form of the error (affine.py), for each of many slices of Psi, as the coefficients vary with it. As saturation
brings two numbers no further apart, the bound holds for the limited outputs too.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb

from codegen.law_constants import LawConstants, law_constants
from codegen.law_equations import differences, drive, move, state_from_words
from codegen.law_frame import (
    Arithmetic,
    LawInput,
    LawState,
    polynomial,
    prefilter,
    region,
    scheduled,
    words_from_state,
)
from records.table import ControllerTable
from records.text.units import unit_of
from records.verification import RoundingBound
from verification.affine import AffineArithmetic, Tracked
from verification.ranges import CE150_MOTION, LawRanges, Motion, Range, declared_ranges

SLICES = 48
METHOD = "affine error forms over Arb balls (python-flint), {slices}{motion}"

Restriction = Callable[[Any, Range], Any]


def rounding_bound(table: ControllerTable, motion: Motion = CE150_MOTION, slices: int = SLICES) -> RoundingBound:
    """The bound per output [V] over the declared ranges of `motion`; raises ValueError where these are too wide to prove."""
    return bound_by_slices(table, motion, slices, METHOD, _slice_bound)


def bound_by_slices(
    table: ControllerTable,
    motion: Motion,
    slices: int,
    method: str,
    bound_of: Callable[[ControllerTable, LawRanges], tuple[float, ...]],
) -> RoundingBound:
    """The largest bound of each output [V] over slices of the scheduling angle; `method` has room for `slices` and `motion`."""
    parts = list(_sliced(declared_ranges(table, motion), table, slices))
    bounds_V = [max(column) for column in zip(*(bound_of(table, part) for part in parts), strict=True)]
    told = method.format(slices=_stated_slices(table, len(parts)), motion=stated_motion(table, motion))
    return rounding_record(table, bounds_V, told)


def _stated_slices(table: ControllerTable, count: int) -> str:
    """Of what the ranges were cut into slices; nothing of a law without a schedule."""
    if table.schedule is None:
        return ""
    symbol = table.loops[table.index(table.schedule.axis)].symbol
    return f"{symbol} in {count} slices, "


def rounding_record(table: ControllerTable, bounds_V: Sequence[float], method: str) -> RoundingBound:
    """The record of the outputs' bounds [V], by their names."""
    units = {loop.voltage: unit_of(loop.input) or "1" for loop in table.loops if loop.input_unit != "V"}
    volts = {loop.voltage: bound for loop, bound in zip(table.loops, bounds_V, strict=True)}
    return RoundingBound(volts, method, units)


def _sliced(ranges: LawRanges, table: ControllerTable, slices: int) -> Iterator[LawRanges]:
    """The ranges cut into slices of the measured scheduling angle; whole without a schedule."""
    if table.schedule is None:
        yield ranges
        return
    index, angles_rad = table.index(table.schedule.axis), ranges.given.angles_rad
    for slice_rad in pairwise(np.linspace(*angles_rad[index], slices + 1).tolist()):
        given = replace(ranges.given, angles_rad=(*angles_rad[:index], slice_rad, *angles_rad[index + 1 :]))
        yield replace(ranges, given=given)


def stated_motion(table: ControllerTable, motion: Motion) -> str:
    """The assumptions of a bound, in words."""
    return " and ".join(
        f"{loop.output} within {_measured(limit, loop.output)}, changing by at most {_measured(rate, loop.output)} a second"
        for loop, limit, rate in zip(table.loops, motion.limits_rad, motion.rates_rad_s, strict=True)
    )


def _measured(value: float, name: str) -> str:
    return f"{value:.3g} {unit_of(name)}".rstrip()


def restricted_voltages(
    law: LawConstants[Any],
    arithmetic: Arithmetic[Any],
    state: LawState[Any],
    given: LawInput[Any],
    ranges: LawRanges,
    restrict: Restriction,
) -> tuple[Any, ...]:
    """The outputs of `law_step` for finite numbers, with `restrict` applied to the differences of the error on the way.

    State and input each within its range may still be a jump that no axis makes; a proof leaves those pairs out.
    """
    schedule_rad = scheduled(law, arithmetic, given.angles_rad)
    filtered = [
        prefilter(axis, arithmetic, remembered, reference_rad)
        for axis, remembered, reference_rad in zip(law.axes, state.axes, given.references_rad, strict=True)
    ]
    region_rad = region(law, filtered)
    voltages = []
    for axis, now, angle_rad, limits_rad in zip(law.axes, filtered, given.angles_rad, ranges.errors_rad, strict=True):
        u_ff_V = polynomial(axis.feedforward_V, region_rad, law.zero)
        e_rad = tuple(restrict(e, limit) for e, limit in zip(differences(now, angle_rad), limits_rad, strict=True))
        v_V = now.v_V + move(axis, now, e_rad, schedule_rad)
        voltages.append(drive(law, axis, arithmetic, now, e_rad, v_V, u_ff_V)[1])
    return tuple(voltages)


def _slice_bound(table: ControllerTable, ranges: LawRanges) -> tuple[float, ...]:
    """The bound of each output for scheduling angles of one slice."""
    arithmetic = AffineArithmetic()
    voltages = restricted_voltages(
        law_constants(table, arithmetic.constant),
        arithmetic,
        state_from_words(table, [arithmetic.within(*limits) for limits in words_from_state(ranges.state)]),
        given_within(ranges, arithmetic),
        ranges,
        _restricted,
    )
    return tuple(voltage.error for voltage in voltages)


def given_within(ranges: LawRanges, arithmetic: Any) -> LawInput[Any]:
    """References and angles as numbers of the arithmetic within their ranges."""
    within = arithmetic.within
    references, angles = ranges.given.references_rad, ranges.given.angles_rad
    return LawInput(tuple(within(*limits) for limits in references), tuple(within(*limits) for limits in angles))


def _restricted(number: Tracked, limits: Range) -> Tracked:
    """The number with its real value cut to `limits`: what holds for all values holds for these."""
    return replace(number, value=number.value.max(arb(limits[0])).min(arb(limits[1])))
