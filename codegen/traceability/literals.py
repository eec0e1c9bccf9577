"""How the C of each arithmetic writes a constant: its literal, and the number that this stands for."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from codegen.fixed.constants import FixedPolynomial, fixed_constants, word_number
from codegen.fixed.formats import count_format, law_formats
from codegen.law_terms import Names, array_name
from codegen.numbers import c_float32
from records.table import ControllerTable


@dataclass(frozen=True)
class Literal:
    """Text in the C, and the number that it stands for in decimal digits."""

    text: str
    number: str


# From a constant's name and value to its literal; None for a constant that the C of this arithmetic does not have.
Write = Callable[[str, float], Literal | None]

_WHOLE = ("_US", "_TICKS", "_PLACES")

LEFT_OUT = Literal("left out, as it would not reach the last place", "0")


def float32_literals(table: ControllerTable) -> Write:
    """Of a float32 law: nine digits each, whole numbers of the header aside."""
    return lambda name, value: _whole(name, value) or _float32(value)


def fixed_literals(table: ControllerTable) -> Write:
    """Of a law in fixed point: a word and its places; raises BadInput for a table that no words can hold."""
    words = dict(_words(table))

    def write(name: str, value: float) -> Literal | None:
        is_coefficient = name.endswith("]")
        return _whole(name, value) or words.get(name, LEFT_OUT if is_coefficient else None)

    return write


LITERALS: Mapping[str, Callable[[ControllerTable], Write]] = {"float32": float32_literals, "fixed": fixed_literals}


def _float32(value: float) -> Literal:
    text = c_float32(value)
    return Literal(text, text.removesuffix("f"))


def _whole(name: str, value: float) -> Literal | None:
    return Literal(f"{value:.0f}", f"{value:.0f}") if name.endswith(_WHOLE) else None


def _word(value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> Literal:
    word = word_number(value, places, made_up)
    return Literal(f"{word} /* {places} places */", repr(word * 2.0**-places))


def _words(table: ControllerTable) -> Iterator[tuple[str, Literal]]:
    law = fixed_constants(table, _word)
    for loop, axis in zip(table.loops, law.axes, strict=True):
        names = Names(loop)
        angle, voltage = names.angle, names.voltage
        for term in axis.terms:
            yield from _coefficients(array_name(loop, term.coefficient), term.polynomial)
        yield from _coefficients(array_name(loop, "u_ff_V"), axis.feedforward_V)
        yield f"LAW_{voltage}_MIN{names.voltage_unit}", axis.u_min_V
        yield f"LAW_{voltage}_MAX{names.voltage_unit}", axis.u_max_V
        yield f"LAW_{voltage}_SAFE{names.voltage_unit}", axis.u_safe_V
        yield f"LAW_{angle}_REF_MIN{names.angle_unit}", axis.reference_min_rad
        yield f"LAW_{angle}_REF_MAX{names.angle_unit}", axis.reference_max_rad
        if axis.prefilter_gain is not None:
            yield f"{axis.name}_limits.prefilter_gain", axis.prefilter_gain
    formats = law_formats(table)
    for loop, own in zip(table.loops, table.axes, strict=True):
        places = formats.angle_places + count_format(formats, own).shift
        yield f"LAW_{Names(loop).angle}_RESOLUTION{Names(loop).angle_unit}", _word(own.resolution_rad, places)
    if law.schedule is not None:
        names = Names(table.loops[law.schedule.index])
        angle = names.angle
        yield f"LAW_{angle}_MIN{names.angle_unit}", law.schedule.min_rad
        yield f"LAW_{angle}_MAX{names.angle_unit}", law.schedule.max_rad
    yield "LAW_ANGLE_LIMIT_RAD", law.angle_max_rad


def _coefficients(name: str, polynomial: FixedPolynomial[Literal]) -> Iterator[tuple[str, Literal]]:
    yield f"{name}[0]", polynomial.constant
    for part in polynomial.powers:
        yield f"{name}[{part.power}]", part.coefficient
