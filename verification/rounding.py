"""A proved bound on what one step of the float32 law can differ from the same step in real numbers.

Both laws start from the same state and inputs, float32 numbers within declared ranges (ranges.py); the real law has the table's
own numbers, the float32 law those rounded. The law's equations are run once on numbers that carry an enclosure of the real value
and an affine form of the error (affine.py), for each of many slices of Psi, as the coefficients vary with it. As saturation
brings two numbers no further apart, the bound holds for the limited outputs too.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb

from codegen.law_constants import LawConstants, law_constants
from codegen.law_equations import (
    Arithmetic,
    LawInput,
    LawOutput,
    LawState,
    differences,
    drive,
    move,
    polynomial,
    prefilter,
    state_from_words,
    words_from_state,
)
from records.table import ControllerTable
from records.verification import RoundingBound
from verification.affine import AffineArithmetic, Tracked
from verification.ranges import LawRanges, Motion, Range, declared_ranges

SLICES = 48
METHOD = "affine error forms over Arb balls (python-flint), Psi in {slices} slices, {motion}"

Restriction = Callable[[Any, Range], Any]


def rounding_bound(table: ControllerTable, motion: Motion | None = None, slices: int = SLICES) -> RoundingBound:
    """The bound per output [V] over the declared ranges of `motion`; raises ValueError where these are too wide to prove."""
    return bound_by_slices(table, motion or Motion(), slices, METHOD, _slice_bound)


def bound_by_slices(
    table: ControllerTable,
    motion: Motion,
    slices: int,
    method: str,
    bound_of: Callable[[ControllerTable, LawRanges], tuple[float, float]],
) -> RoundingBound:
    """The largest bounds of u_M and u_T [V] over slices of the measured elevation; `method` has room for `slices` and `motion`."""
    ranges = declared_ranges(table, motion)
    edges_rad = np.linspace(*ranges.given.psi_rad, slices + 1).tolist()
    parts = (replace(ranges, given=replace(ranges.given, psi_rad=psi_rad)) for psi_rad in pairwise(edges_rad))
    u_M_V, u_T_V = (max(column) for column in zip(*(bound_of(table, part) for part in parts), strict=True))
    return RoundingBound(u_M_V, u_T_V, method.format(slices=slices, motion=stated_motion(motion)))


def stated_motion(motion: Motion) -> str:
    """The assumptions of a bound, in words."""
    angles = f"angles within {motion.psi_limit_rad:g} and {motion.phi_limit_rad:g} rad"
    return f"{angles} moving at most {motion.psi_rate_rad_s:g} and {motion.phi_rate_rad_s:g} rad/s"


def restricted_voltages(
    law: LawConstants[Any],
    arithmetic: Arithmetic[Any],
    state: LawState[Any],
    given: LawInput[Any],
    ranges: LawRanges,
    restrict: Restriction,
) -> LawOutput[Any]:
    """The outputs of `law_step` for finite numbers, with `restrict` applied to the differences of the error on the way.

    State and input each within its range may still be a jump that no axis makes; a proof leaves those pairs out.
    """
    schedule_rad = arithmetic.clamp(given.psi_rad, law.psi_min_rad, law.psi_max_rad)
    schedule_rad = arithmetic.settle(schedule_rad, law.least_schedule_rad)
    elevation = prefilter(law.elevation, arithmetic, state.elevation, given.psi_ref_rad)
    azimuth = prefilter(law.azimuth, arithmetic, state.azimuth, given.phi_ref_rad)
    voltages = []
    for axis, now, angle_rad, allowed in (
        (law.elevation, elevation, given.psi_rad, ranges.state.elevation),
        (law.azimuth, azimuth, given.phi_rad, ranges.state.azimuth),
    ):
        u_ff_V = polynomial(axis.feedforward_V, elevation.reference_2_rad, law.zero)
        third_rad = (2.0 * allowed.e_2_rad[0], 2.0 * allowed.e_2_rad[1])
        limits_rad = (allowed.e_0_rad, allowed.e_1_rad, allowed.e_2_rad, third_rad)
        e_rad = tuple(restrict(e, limit) for e, limit in zip(differences(now, angle_rad), limits_rad, strict=True))
        v_V = now.v_V + move(axis, now, e_rad, schedule_rad)
        voltages.append(drive(law, axis, arithmetic, now, e_rad, v_V, u_ff_V)[1])
    return LawOutput(*voltages)


def _slice_bound(table: ControllerTable, ranges: LawRanges) -> tuple[float, float]:
    """The bound of u_M and u_T for measured elevations of one slice."""
    arithmetic = AffineArithmetic()
    law = law_constants(table, arithmetic.constant)
    output = restricted_voltages(
        law,
        arithmetic,
        state_from_words([arithmetic.within(*limits) for limits in words_from_state(ranges.state)]),
        LawInput(*(arithmetic.within(*getattr(ranges.given, name)) for name in LawInput.__dataclass_fields__)),
        ranges,
        _restricted,
    )
    return output.u_M_V.error, output.u_T_V.error


def _restricted(number: Tracked, limits: Range) -> Tracked:
    """The number with its real value cut to `limits`: what holds for all values holds for these."""
    return replace(number, value=number.value.max(arb(limits[0])).min(arb(limits[1])))
