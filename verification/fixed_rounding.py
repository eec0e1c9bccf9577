"""A proved bound on what one step of the fixed-point law can differ from the same step in real numbers.

As rounding.py for float32, over the same declared ranges and slices of Psi, with words that carry their error (fixed_words.py).
The real law has the table's own numbers; both start from the same state and inputs.
"""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb

from codegen.fixed_constants import FixedAxis, FixedLaw, fixed_constants
from codegen.fixed_equations import (
    AxisState,
    differences,
    drive,
    move,
    polynomial,
    powers_of,
    prefilter,
    schedule,
    within_ranges,
)
from codegen.fixed_formats import LawFormats, law_formats
from codegen.law_equations import AxisState as DeclaredState
from records.table import ControllerTable
from records.verification import RoundingBound
from verification.fixed_words import TrackedWord, TrackedWords
from verification.ranges import LawRanges, Motion, Range, declared_ranges
from verification.rounding import SLICES, stated_motion

METHOD = "affine error forms of words over Arb balls (python-flint), Psi in {slices} slices, {motion}"


def fixed_rounding_bound(table: ControllerTable, motion: Motion | None = None, slices: int = SLICES) -> RoundingBound:
    """The bound per output [V] over the declared ranges of `motion`; raises BadInput for a table that no words can hold."""
    motion = motion or Motion()
    ranges = declared_ranges(table, motion)
    edges_rad = np.linspace(*ranges.given.psi_rad, slices + 1)
    bounds = [_slice_bound(table, ranges, (float(low), float(high))) for low, high in pairwise(edges_rad)]
    u_M_V, u_T_V = (max(column) for column in zip(*bounds, strict=True))
    return RoundingBound(u_M_V, u_T_V, METHOD.format(slices=slices, motion=stated_motion(motion)))


def _slice_bound(table: ControllerTable, ranges: LawRanges, psi_rad: Range) -> tuple[float, float]:
    """The bound of u_M and u_T for measured elevations of one slice; the equations are those of `law_step`."""
    words, formats = TrackedWords(), law_formats(table)
    law: FixedLaw[Any] = fixed_constants(table, words.constant)
    given = replace(ranges.given, psi_rad=psi_rad)
    angles = {name: _words(words, getattr(given, name), formats.angle_places) for name in vars(given)}
    psi = schedule(law, words, angles["psi_rad"])
    states = (
        _state(words, formats, ranges.state.elevation, formats.elevation.reference_places),
        _state(words, formats, ranges.state.azimuth, formats.azimuth.reference_places),
    )
    filtered = [
        prefilter(law, axis, words, state, angles[name])[1]
        for axis, state, name in zip((law.elevation, law.azimuth), states, ("psi_ref_rad", "phi_ref_rad"), strict=True)
    ]
    psi_ref = powers_of(law, words, filtered[0] * 2**law.reference_doublings)
    outputs = [
        _output(law, axis, words, state, filtered_rad, angles[name], psi, psi_ref, (allowed, formats.angle_places))
        for axis, state, filtered_rad, name, allowed in (
            (law.elevation, states[0], filtered[0], "psi_rad", ranges.state.elevation),
            (law.azimuth, states[1], filtered[1], "phi_rad", ranges.state.azimuth),
        )
    ]
    u_M_V, u_T_V = (output.error * 2.0**-formats.voltage_places for output in outputs)
    return u_M_V, u_T_V


def _output(
    law: FixedLaw[Any],
    axis: FixedAxis[Any],
    words: TrackedWords,
    state: AxisState[Any],
    filtered_rad: TrackedWord,
    angle_rad: TrackedWord,
    psi: tuple[Any, ...],
    psi_ref: tuple[Any, ...],
    allowed: tuple[DeclaredState[Range], int],
) -> TrackedWord:
    """The limited voltage of one axis; jumps of the error that no axis makes are left out, as in rounding.py."""
    ranges, places = allowed
    kept = within_ranges(law, axis, words, state)
    third_rad = (2.0 * ranges.e_2_rad[0], 2.0 * ranges.e_2_rad[1])
    limits_rad = (ranges.e_0_rad, ranges.e_1_rad, ranges.e_2_rad, third_rad)
    e_rad = tuple(
        _restricted(e, limit, places)
        for e, limit in zip(differences(axis, words, kept, filtered_rad, angle_rad), limits_rad, strict=True)
    )
    move_V = words.whole(move(axis, words, kept, e_rad, psi), axis.residue_places)
    u_ff_V = polynomial(axis.feedforward_V, words, psi_ref, f"{axis.name}.u_ff_V")
    output: TrackedWord = drive(law, axis, words, kept, e_rad, move_V, u_ff_V)[1]
    return output


def _state(
    words: TrackedWords, formats: LawFormats, declared: DeclaredState[Range], reference_places: int
) -> AxisState[Any]:
    places = {"reference_1_rad": reference_places, "reference_2_rad": reference_places}
    places |= {f"e_{i}_rad": formats.angle_places for i in range(3)}
    places |= {f"{letter}_{i}_V": formats.voltage_places for letter in "sw" for i in range(3)}
    numbers = {name: _words(words, getattr(declared, name), count) for name, count in places.items()}
    return AxisState(v_residue=words.within(0.0, 0.0), **numbers)


def _words(words: TrackedWords, limits: Range, places: int) -> TrackedWord:
    return words.within(limits[0] * 2.0**places, limits[1] * 2.0**places)


def _restricted(number: TrackedWord, limits: Range, places: int) -> TrackedWord:
    low, high = (arb(limit * 2.0**places) for limit in limits)
    return replace(number, value=number.value.max(low).min(high))
