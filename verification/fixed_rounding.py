"""A proved bound on what one step of the fixed-point law can differ from the same step in real numbers.

As rounding.py for float32, over the same declared ranges and slices of Psi, with words that carry their error (fixed_words.py).
The real law has the table's own numbers; both start from the same state and inputs.
"""

from itertools import starmap
from typing import Any

from codegen.fixed.constants import FixedAxis, FixedLaw, fixed_constants
from codegen.fixed.equations import (
    differences,
    drive,
    feedforward,
    fixed_axis_state,
    move,
    prefilter,
    region,
    schedule,
    within_ranges,
)
from codegen.fixed.formats import LawFormats, law_formats
from records.table import ControllerTable
from records.verification import RoundingBound
from verification.fixed_words import ErrorWords, TrackedWords
from verification.ranges import CE150_MOTION, LawRanges, Motion, Range
from verification.rounding import SLICES, bound_by_slices

METHOD = "affine error forms of words over Arb balls (python-flint), {slices}{motion}"


def fixed_rounding_bound(table: ControllerTable, motion: Motion = CE150_MOTION, slices: int = SLICES) -> RoundingBound:
    """The bound per output [V] over the declared ranges of `motion`; raises BadInput for a table that no words can hold."""
    return bound_by_slices(table, motion, slices, METHOD, _slice_bound)


def _slice_bound(table: ControllerTable, ranges: LawRanges) -> tuple[float, ...]:
    """The bound of each output for scheduling angles of one slice."""
    step_V = 2.0 ** -law_formats(table).voltage_places
    return tuple(word.error * step_V for word in restricted_voltages(table, TrackedWords(), ranges))


def restricted_voltages(table: ControllerTable, words: ErrorWords[Any], ranges: LawRanges) -> tuple[Any, ...]:
    """The words of all outputs by the equations of `law_step`; jumps of the error that no axis makes are left out."""
    formats = law_formats(table)
    law: FixedLaw[Any] = fixed_constants(table, words.constant)
    angles, references = (
        [_words(words, limits, formats.angle_places) for limits in given]
        for given in (ranges.given.angles_rad, ranges.given.references_rad)
    )
    psi = schedule(law, words, angles)
    states = [
        _state(words, formats, declared, own.reference_places)
        for declared, own in zip(ranges.state.axes, formats.axes, strict=True)
    ]
    filtered = [
        prefilter(law, axis, words, state, reference)[1]
        for axis, state, reference in zip(law.axes, states, references, strict=True)
    ]
    psi_ref = region(law, words, filtered)

    def output_V(axis: FixedAxis[Any], state: Any, filtered_rad: Any, angle: Any, limits_rad: tuple[Range, ...]) -> Any:
        kept = within_ranges(law, axis, words, state)
        e_rad = tuple(
            _restricted(words, e, limits, formats.angle_places)
            for e, limits in zip(differences(axis, words, kept, filtered_rad, angle), limits_rad, strict=True)
        )
        move_V = words.whole(move(axis, words, kept, e_rad, psi), axis.residue_places)
        return drive(law, axis, words, kept, e_rad, move_V, feedforward(axis, words, psi_ref))[1]

    return tuple(starmap(output_V, zip(law.axes, states, filtered, angles, ranges.errors_rad, strict=True)))


def _state(words: ErrorWords[Any], formats: LawFormats, declared: Any, reference_places: int) -> Any:
    places = {"reference_1_rad": reference_places, "reference_2_rad": reference_places}
    places |= dict.fromkeys(declared.E, formats.angle_places)
    places |= dict.fromkeys((*declared.S, *declared.W), formats.voltage_places)
    numbers = {name: _words(words, getattr(declared, name), count) for name, count in places.items()}
    return fixed_axis_state(len(declared.E))(v_residue=words.within(0.0, 0.0), **numbers)


def _words(words: ErrorWords[Any], limits: Range, places: int) -> Any:
    return words.within(*_whole(limits, places))


def _restricted(words: ErrorWords[Any], word: Any, limits: Range, places: int) -> Any:
    return words.restricted(word, *_whole(limits, places))


def _whole(limits: Range, places: int) -> Range:
    return limits[0] * 2.0**places, limits[1] * 2.0**places
