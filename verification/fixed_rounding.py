"""A proved bound on what one step of the fixed-point law can differ from the same step in real numbers.

As rounding.py for float32, over the same declared ranges and slices of Psi, with words that carry their error (fixed_words.py).
The real law has the table's own numbers; both start from the same state and inputs.
"""

from typing import Any

from codegen.fixed.constants import FixedAxis, FixedLaw, fixed_constants
from codegen.fixed.equations import (
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
from codegen.fixed.formats import LawFormats, law_formats
from codegen.law_equations import AxisState as DeclaredState
from records.table import ControllerTable
from records.verification import RoundingBound
from verification.fixed_words import ErrorWords, TrackedWords
from verification.ranges import LawRanges, Motion, Range
from verification.rounding import SLICES, bound_by_slices

METHOD = "affine error forms of words over Arb balls (python-flint), Psi in {slices} slices, {motion}"


def fixed_rounding_bound(table: ControllerTable, motion: Motion | None = None, slices: int = SLICES) -> RoundingBound:
    """The bound per output [V] over the declared ranges of `motion`; raises BadInput for a table that no words can hold."""
    return bound_by_slices(table, motion or Motion(), slices, METHOD, _slice_bound)


def _slice_bound(table: ControllerTable, ranges: LawRanges) -> tuple[float, float]:
    """The bound of u_M and u_T for measured elevations of one slice."""
    u_M, u_T = restricted_voltages(table, TrackedWords(), ranges)
    step_V = 2.0 ** -law_formats(table).voltage_places
    return u_M.error * step_V, u_T.error * step_V


def restricted_voltages(table: ControllerTable, words: ErrorWords[Any], ranges: LawRanges) -> tuple[Any, Any]:
    """The words of u_M and u_T by the equations of `law_step`; jumps of the error that no axis makes are left out."""
    formats = law_formats(table)
    law: FixedLaw[Any] = fixed_constants(table, words.constant)
    angles = {name: _words(words, limits, formats.angle_places) for name, limits in vars(ranges.given).items()}
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
    u_M, u_T = (
        _output(law, axis, words, state, filtered_rad, angles[name], psi, psi_ref, (allowed, formats.angle_places))
        for axis, state, filtered_rad, name, allowed in (
            (law.elevation, states[0], filtered[0], "psi_rad", ranges.state.elevation),
            (law.azimuth, states[1], filtered[1], "phi_rad", ranges.state.azimuth),
        )
    )
    return u_M, u_T


def _output(
    law: FixedLaw[Any],
    axis: FixedAxis[Any],
    words: ErrorWords[Any],
    state: AxisState[Any],
    filtered_rad: Any,
    angle_rad: Any,
    psi: tuple[Any, ...],
    psi_ref: tuple[Any, ...],
    allowed: tuple[DeclaredState[Range], int],
) -> Any:
    """The limited voltage of one axis."""
    ranges, places = allowed
    kept = within_ranges(law, axis, words, state)
    third_rad = (2.0 * ranges.e_2_rad[0], 2.0 * ranges.e_2_rad[1])
    limits_rad = (ranges.e_0_rad, ranges.e_1_rad, ranges.e_2_rad, third_rad)
    e_rad = tuple(
        words.restricted(e, limit[0] * 2.0**places, limit[1] * 2.0**places)
        for e, limit in zip(differences(axis, words, kept, filtered_rad, angle_rad), limits_rad, strict=True)
    )
    move_V = words.whole(move(axis, words, kept, e_rad, psi), axis.residue_places)
    u_ff_V = polynomial(axis.feedforward_V, words, psi_ref, f"{axis.name}.u_ff_V")
    return drive(law, axis, words, kept, e_rad, move_V, u_ff_V)[1]


def _state(
    words: ErrorWords[Any], formats: LawFormats, declared: DeclaredState[Range], reference_places: int
) -> AxisState[Any]:
    places = {"reference_1_rad": reference_places, "reference_2_rad": reference_places}
    places |= {f"e_{i}_rad": formats.angle_places for i in range(3)}
    places |= {f"s_{i}_V": formats.voltage_places for i in range(4)}
    places |= {f"w_{i}_V": formats.voltage_places for i in range(3)}
    numbers = {name: _words(words, getattr(declared, name), count) for name, count in places.items()}
    return AxisState(v_residue=words.within(0.0, 0.0), **numbers)


def _words(words: ErrorWords[Any], limits: Range, places: int) -> Any:
    return words.within(limits[0] * 2.0**places, limits[1] * 2.0**places)
