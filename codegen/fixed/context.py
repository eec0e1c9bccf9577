"""What the templates of the fixed-point law are filled with: words, formats, and the ranges that were proved for them."""

from dataclasses import dataclass
from typing import Any

from codegen.fixed.constants import FixedLaw, FixedPolynomial, FixedTerm, fixed_constants, word_number
from codegen.fixed.duty import duty_format
from codegen.fixed.equations import fixed_axis_state
from codegen.fixed.formats import FILTERED_BITS, CountFormat, LawFormats, count_format, law_formats
from codegen.fixed.polynomials import PolynomialFormat
from codegen.fixed.ranges import OverflowProof, Range, prove_no_overflow
from codegen.law_terms import Names, coefficient_unit
from records.loops import Loop, full_scales_V
from records.table import ControllerTable
from records.text.units import unit_of

SCHEDULE = "schedule"  # what the powers of the scheduling angle are called in the C, and with _ref behind it those of its reference


@dataclass(frozen=True)
class FixedCoefficient:
    """One entry of a polynomial's table, and what it adds to the value in the C text (nothing for the constant)."""

    word: int
    places: int
    product: str


@dataclass(frozen=True)
class Polynomial:
    """One coefficient or feed-forward as a C function of `of`, a pointer to powers."""

    name: str
    unit: str
    places: int
    range: Range
    of: str
    coefficients: tuple[FixedCoefficient, ...]


@dataclass(frozen=True)
class Term:
    """One product of the move of v."""

    sign: str
    product: str


@dataclass(frozen=True)
class Axis:
    """One axis as the template sees it."""

    loop: Loop
    angle: str
    angle_unit: str
    voltage: str
    voltage_unit: str
    filter: str
    prefilter_gain: int
    prefilter_time_constant_s: float
    polynomials: tuple[Polynomial, ...]
    terms: tuple[Term, ...]
    uses_last: bool
    sum_places: int
    residue_places: int
    residue_mask: str
    half_residue: int
    reference_doublings: int
    reference_places: int
    half_step: int
    steps: int
    counts: CountFormat
    reference_spans_zero: bool

    @property
    def name(self) -> str:
        """The loop's."""
        return self.loop.axis


def fixed_context(table: ControllerTable) -> dict[str, Any]:
    """Names of the templates law_fixed.*.j2; raises BadInput for a table whose law could not run, or could overflow."""
    proof = prove_no_overflow(table)
    law, formats = fixed_constants(table, word_number), law_formats(table)
    axes = tuple(_axis(table, index, law, formats, proof) for index in range(len(table.loops)))
    return {
        "formats": formats,
        "voltage_limits": _voltage_limits(table, law),
        "angle_limits": _angle_limits(table, law, formats),
        "axis_state_fields": tuple(fixed_axis_state(table.order).__dataclass_fields__),
        "powers": list(range(table.order + 1)),
        "axes": axes,
        "filters": {axis.filter for axis in axes},
        "multiplies_scaled": formats.degree > 1
        or any(part.products == 3 for p in _all_polynomials(law) for part in p.powers),
        "multiplies_short": any(part.products == 2 for p in _all_polynomials(law) for part in p.powers),
        "multiplies_narrow": any(term.is_narrow for axis in law.axes for term in axis.terms),
        "multiplies_short_words": any(term.is_short for axis in law.axes for term in axis.terms),
        "shifts_products": any(term.excess for axis in law.axes for term in axis.terms),
        "places": {
            "schedule": formats.angle_places + law.schedule_doublings,
            "reference": formats.region_places + law.reference_doublings,
        },
        "degree": formats.degree,
        "bits": {"filtered": FILTERED_BITS, "error": law.error_bits, "s": law.s_bits, "w": law.w_bits},
        "schedule_steps": 2**law.schedule_doublings,
        "reference_steps": 2**law.reference_doublings,
        "duty_forms": {scale_V: duty_format(scale_V, formats.voltage_places) for scale_V in full_scales_V(table.loops)},
    }


def _all_polynomials(law: FixedLaw[int]) -> list[FixedPolynomial[int]]:
    return [p for axis in law.axes for p in (*(term.polynomial for term in axis.terms), axis.feedforward_V)]


def _axis(table: ControllerTable, index: int, law: FixedLaw[int], formats: LawFormats, proof: OverflowProof) -> Axis:
    loop, axis, own = table.loops[index], law.axes[index], formats.axes[index]
    names, stated = Names(loop), table.axes[index]
    polynomials = [
        _polynomial(loop, term.coefficient, term.polynomial, form.polynomial, SCHEDULE, proof)
        for term, form in zip(axis.terms, own.terms, strict=True)
    ]
    polynomials.append(_polynomial(loop, "u_ff_V", axis.feedforward_V, own.feedforward, f"{SCHEDULE}_ref", proof))
    last = f"e_{table.order}_rad"
    return Axis(
        loop=loop,
        angle=names.angle,
        angle_unit=names.angle_unit,
        voltage=names.voltage,
        voltage_unit=names.voltage_unit,
        filter="take_reference" if axis.prefilter_gain is None else "prefilter",
        prefilter_gain=axis.prefilter_gain or 0,
        prefilter_time_constant_s=stated.prefilter_time_constant_s,
        polynomials=tuple(polynomials),
        terms=tuple(Term("+" if term.sign > 0 else "-", _product(axis.name, term, last)) for term in axis.terms),
        uses_last=any(term.factor == last for term in axis.terms),
        sum_places=own.sum_places,
        residue_places=axis.residue_places,
        residue_mask=f"0x{2**axis.residue_places - 1:X}",
        half_residue=axis.half_residue,
        reference_doublings=axis.reference_doublings,
        reference_places=own.reference_places,
        half_step=2 ** (axis.reference_doublings - 1),
        steps=2**axis.reference_doublings,
        counts=count_format(formats, stated),
        reference_spans_zero=axis.reference_spans_zero,
    )


def _product(axis: str, term: FixedTerm[int], last: str) -> str:
    if term.factor.startswith("e_"):
        factor = term.factor if term.factor == last else f"self->{term.factor}"
    else:
        factor = f"past->{term.factor}"
    function = "short_product" if term.is_short else "narrow_product" if term.is_narrow else "product"
    product = f"{function}({axis}_{term.coefficient}({SCHEDULE}), {factor})"
    if term.doublings:
        return f"({product} << {term.doublings}u)"
    return f"floored_product({product}, {term.excess}u)" if term.excess else product


def _polynomial(
    loop: Loop, name: str, p: FixedPolynomial[int], form: PolynomialFormat, of: str, proof: OverflowProof
) -> Polynomial:
    coefficients = [FixedCoefficient(p.constant, form.places, "")]
    for index, (part, shape) in enumerate(zip(p.powers, form.powers, strict=True), start=1):
        factors = f"c[{index}], {of}->x_{part.power}"
        text = {
            1: f"floored(c[{index}] * floored({of}->x_{part.power}, 16u), {part.shift}u)",
            2: f"floored(scaled_short({factors}), {part.shift}u)",
            3: f"{2**part.shift} * scaled({factors})" if part.shift else f"scaled({factors})",
        }[part.products]
        coefficients.append(FixedCoefficient(part.coefficient, shape.places, text))
    return Polynomial(
        name=name,
        unit=coefficient_unit(loop, "u_ff" if name == "u_ff_V" else name[0]),
        places=form.places,
        range=proof.ranges[f"{loop.axis}.{name}"],
        of=of,
        coefficients=tuple(coefficients),
    )


def _voltage_limits(table: ControllerTable, law: FixedLaw[int]) -> list[tuple[str, int, float, str]]:
    rows = []
    for loop, axis, own in zip(table.loops, law.axes, table.axes, strict=True):
        prefix, end, unit = Names(loop).voltage, Names(loop).voltage_unit, unit_of(loop.input)
        rows += [
            (f"{prefix}_MIN{end}", axis.u_min_V, own.u_min_V, unit),
            (f"{prefix}_MAX{end}", axis.u_max_V, own.u_max_V, unit),
            (f"{prefix}_SAFE{end}", axis.u_safe_V, own.u_safe_V, unit),
        ]
    return rows


def _angle_limits(table: ControllerTable, law: FixedLaw[int], formats: LawFormats) -> list[tuple[str, int, str, str]]:
    rows: list[tuple[str, int, float, str]] = []
    for loop, axis, own in zip(table.loops, law.axes, table.axes, strict=True):
        prefix, end, unit = Names(loop).angle, Names(loop).angle_unit, unit_of(loop.output)
        rows += [
            (f"{prefix}_REF_MIN{end}", axis.reference_min_rad, own.reference_min_rad, unit),
            (f"{prefix}_REF_MAX{end}", axis.reference_max_rad, own.reference_max_rad, unit),
        ]
    if law.schedule is not None and table.schedule is not None:
        loop = table.loops[law.schedule.index]
        prefix, end, unit = Names(loop).angle, Names(loop).angle_unit, unit_of(loop.output)
        rows += [
            (f"{prefix}_MIN{end}", law.schedule.min_rad, table.schedule.min_rad, unit),
            (f"{prefix}_MAX{end}", law.schedule.max_rad, table.schedule.max_rad, unit),
        ]
    units = " or ".join(dict.fromkeys(unit_of(loop.output) or "1" for loop in table.loops))
    rows.append(("ANGLE_LIMIT_RAD", law.angle_max_rad, formats.angle_limit_rad, units))
    return [(name, word, f"{value:.9g}", unit) for name, word, value, unit in rows]
