"""The words of the fixed-point law, made from a controller table in its formats."""

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from codegen.fixed.formats import LawFormats, gain_word, law_formats
from codegen.fixed.polynomials import WORD_BITS, PolynomialFormat
from codegen.law_constants import law_constants
from codegen.law_frame import ScheduleNumbers, schedule_numbers
from records.table import AxisLaw, ControllerTable

N = TypeVar("N")
N_co = TypeVar("N_co", covariant=True)


class MakeNumber(Protocol[N_co]):
    """Makes a number of the law: its real value, its places, last places to add to its word, what left-out terms add at most."""

    def __call__(self, value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> N_co: ...


@dataclass(frozen=True)
class FixedPower(Generic[N]):
    """The part of a polynomial of one power of its angle, see polynomials.PowerFormat."""

    power: int
    coefficient: N
    products: int
    shift: int


@dataclass(frozen=True)
class FixedPolynomial(Generic[N]):
    """A constant and the powers that are not negligible."""

    constant: N
    powers: tuple[FixedPower[N], ...]


@dataclass(frozen=True)
class FixedTerm(Generic[N]):
    """One product of the move of v; `excess` and `doublings` are the shifts to the places of the sum."""

    coefficient: str
    factor: str
    sign: int
    polynomial: FixedPolynomial[N]
    excess: int
    doublings: int
    is_narrow: bool
    is_short: bool


@dataclass(frozen=True)
class FixedAxis(Generic[N]):
    """Words of one axis. References as they cross the line and, with 2^reference_doublings as many steps, filtered."""

    name: str
    terms: tuple[FixedTerm[N], ...]
    feedforward_V: FixedPolynomial[N]
    prefilter_gain: N | None
    reference_doublings: int
    reference_spans_zero: bool
    reference_min_rad: N
    reference_max_rad: N
    residue_places: int
    half_residue: N
    u_min_V: N
    u_max_V: N
    u_safe_V: N
    zero: N


@dataclass(frozen=True)
class FixedLaw(Generic[N]):
    """Words of all axes, the schedule's range, and the ranges in which the law keeps its numbers; `order` as the table's."""

    order: int
    axes: tuple[FixedAxis[N], ...]
    angle_min_rad: N
    angle_max_rad: N
    schedule: ScheduleNumbers[N] | None
    schedule_doublings: int
    reference_doublings: int
    degree: int
    error_bits: int
    s_bits: int
    w_bits: int
    zero: N


def word_number(value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> int:
    """The nearest word."""
    return round(value * 2.0**places + made_up)


def fixed_constants(table: ControllerTable, number: MakeNumber[N]) -> FixedLaw[N]:
    """The law's numbers, each made by `number`; raises BadInput for a table that no law can fly or no word can hold."""
    law_constants(table, float)  # refuses what no arithmetic could run
    formats = law_formats(table)
    angle = formats.angle_places
    limit_rad = formats.angle_limit_rad - 2.0**-angle
    return FixedLaw(
        order=table.order,
        axes=tuple(_axis(table, loop.axis, formats, number) for loop in table.loops),
        angle_min_rad=number(-limit_rad, angle),
        angle_max_rad=number(limit_rad, angle),
        schedule=schedule_numbers(table, lambda value: number(value, angle)),
        schedule_doublings=WORD_BITS - formats.schedule_bits - angle,
        reference_doublings=WORD_BITS - formats.reference_bits - formats.region_places,
        degree=formats.degree,
        error_bits=formats.error_bits,
        s_bits=formats.s_bits,
        w_bits=formats.w_bits,
        zero=number(0.0, 0),
    )


def _axis(table: ControllerTable, name: str, formats: LawFormats, number: MakeNumber[N]) -> FixedAxis[N]:
    axis, own = table.axis(name), formats.axes[table.index(name)]
    angle, voltage = formats.angle_places, formats.voltage_places
    residue_places = own.sum_places - voltage
    terms = tuple(
        FixedTerm(
            term.coefficient,
            term.factor,
            term.sign,
            _polynomial(term.polynomial, number),
            term.excess,
            term.doublings,
            term.is_narrow,
            term.is_short,
        )
        for term in own.terms
    )
    gain = gain_word(axis, table.sample_period_s)
    # A filtered limit is the line's limit with more places, so that both are the same number.
    low_rad, high_rad = (round(limit * 2.0**angle) / 2.0**angle for limit in _reference_range(axis))
    return FixedAxis(
        name=name,
        terms=terms,
        feedforward_V=_polynomial(own.feedforward, number),
        prefilter_gain=None if axis.prefilter_time_constant_s == 0.0 else number(gain, WORD_BITS),
        reference_doublings=own.reference_places - angle,
        reference_spans_zero=low_rad <= 0.0 <= high_rad,
        reference_min_rad=number(low_rad, angle),
        reference_max_rad=number(high_rad, angle),
        residue_places=residue_places,
        half_residue=number(0.5, residue_places),
        u_min_V=number(axis.u_min_V, voltage),
        u_max_V=number(axis.u_max_V, voltage),
        u_safe_V=number(axis.u_safe_V, voltage),
        zero=number(0.0, 0),
    )


def _reference_range(axis: AxisLaw) -> tuple[float, float]:
    return axis.reference_min_rad, axis.reference_max_rad


def _polynomial(p: PolynomialFormat, number: MakeNumber[N]) -> FixedPolynomial[N]:
    powers = tuple(
        FixedPower(part.power, number(part.coefficient, part.places), part.products, part.shift) for part in p.powers
    )
    return FixedPolynomial(number(p.constant, p.places, p.made_up, p.neglected), powers)
