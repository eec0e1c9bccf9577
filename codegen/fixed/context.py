"""What the templates of the fixed-point law are filled with: words, formats, and the ranges that were proved for them."""

from dataclasses import dataclass
from typing import Any

from codegen.fixed.constants import FixedAxis, FixedLaw, FixedPolynomial, FixedTerm, fixed_constants, word_number
from codegen.fixed.equations import AXIS_STATE_FIELDS
from codegen.fixed.formats import FILTERED_BITS, AxisFormats, CountFormat, LawFormats, count_format, law_formats
from codegen.fixed.polynomials import PolynomialFormat
from codegen.fixed.ranges import OverflowProof, Range, prove_no_overflow
from codegen.fixed.twin import duty_ratio
from codegen.law_equations import LAST_ACCEPTED_FIELDS
from codegen.law_terms import PREFIXES, UNITS
from codegen.twin import FULL_SCALE_V
from records.table import AxisLaw, ControllerTable


@dataclass(frozen=True)
class Coefficient:
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
    coefficients: tuple[Coefficient, ...]


@dataclass(frozen=True)
class Term:
    """One product of the move of v."""

    sign: str
    product: str


@dataclass(frozen=True)
class Axis:
    """One axis as the template sees it."""

    name: str
    angle: str
    voltage: str
    filter: str
    prefilter_gain: int
    prefilter_time_constant_s: float
    polynomials: tuple[Polynomial, ...]
    terms: tuple[Term, ...]
    uses_third: bool
    sum_places: int
    residue_places: int
    residue_mask: str
    half_residue: int
    reference_doublings: int
    half_step: int
    steps: int
    counts: CountFormat
    reference_spans_zero: bool


def fixed_context(table: ControllerTable) -> dict[str, Any]:
    """Names of the templates law_fixed.*.j2; raises BadInput for a table whose law could not run, or could overflow."""
    proof = prove_no_overflow(table)
    law, formats = fixed_constants(table, word_number), law_formats(table)
    axes = (
        _axis(table.elevation, law.elevation, formats, formats.elevation, proof),
        _axis(table.azimuth, law.azimuth, formats, formats.azimuth, proof),
    )
    factor, shift = duty_ratio(formats.voltage_places)
    return {
        "formats": formats,
        "voltage_limits": _voltage_limits(table, law),
        "angle_limits": _angle_limits(table, law, formats),
        "axis_state_fields": AXIS_STATE_FIELDS,
        "last_accepted_fields": LAST_ACCEPTED_FIELDS,
        "axes": axes,
        "filters": {axis.filter for axis in axes},
        "multiplies_short": any(part.products == 2 for p in _all_polynomials(law) for part in p.powers),
        "multiplies_narrow": any(term.is_narrow for axis in (law.elevation, law.azimuth) for term in axis.terms),
        "multiplies_short_words": any(term.is_short for axis in (law.elevation, law.azimuth) for term in axis.terms),
        "shifts_products": any(term.excess for axis in (law.elevation, law.azimuth) for term in axis.terms),
        "places": {
            "schedule": formats.angle_places + law.schedule_doublings,
            "reference": formats.elevation.reference_places + law.reference_doublings,
        },
        "degree": formats.degree,
        "bits": {"filtered": FILTERED_BITS, "error": law.error_bits, "s": law.s_bits, "w": law.w_bits},
        "schedule_steps": 2**law.schedule_doublings,
        "reference_steps": 2**law.reference_doublings,
        "full_scale": word_number(FULL_SCALE_V, formats.voltage_places),
        "duty_factor": factor,
        "duty_shift": shift,
        "duty_half": 2 ** (shift - 1),
    }


def _all_polynomials(law: FixedLaw[int]) -> list[FixedPolynomial[int]]:
    axes = (law.elevation, law.azimuth)
    return [p for axis in axes for p in (*(term.polynomial for term in axis.terms), axis.feedforward_V)]


def _axis(law: AxisLaw, axis: FixedAxis[int], formats: LawFormats, own: AxisFormats, proof: OverflowProof) -> Axis:
    angle, voltage = PREFIXES[axis.name]
    polynomials = [
        _polynomial(axis.name, term.coefficient, term.polynomial, form.polynomial, "psi", proof)
        for term, form in zip(axis.terms, own.terms, strict=True)
    ]
    polynomials.append(_polynomial(axis.name, "u_ff_V", axis.feedforward_V, own.feedforward, "psi_ref", proof))
    return Axis(
        name=axis.name,
        angle=angle,
        voltage=voltage,
        filter="take_reference" if axis.prefilter_gain is None else "prefilter",
        prefilter_gain=axis.prefilter_gain or 0,
        prefilter_time_constant_s=law.prefilter_time_constant_s,
        polynomials=tuple(polynomials),
        terms=tuple(Term("+" if term.sign > 0 else "-", _product(axis.name, term)) for term in axis.terms),
        uses_third=any(term.factor == "e_3_rad" for term in axis.terms),
        sum_places=own.sum_places,
        residue_places=axis.residue_places,
        residue_mask=f"0x{2**axis.residue_places - 1:X}",
        half_residue=axis.half_residue,
        reference_doublings=axis.reference_doublings,
        half_step=2 ** (axis.reference_doublings - 1),
        steps=2**axis.reference_doublings,
        counts=count_format(formats, law),
        reference_spans_zero=axis.reference_spans_zero,
    )


def _product(axis: str, term: FixedTerm[int]) -> str:
    places = {"e_3_rad": "e_3_rad", **{f"e_{i}_rad": f"self->e_{i}_rad" for i in range(3)}}
    factor = places.get(term.factor, f"past->{term.factor}")
    function = "short_product" if term.is_short else "narrow_product" if term.is_narrow else "product"
    product = f"{function}({axis}_{term.coefficient}(psi), {factor})"
    if term.doublings:
        return f"({product} << {term.doublings}u)"
    return f"floored_product({product}, {term.excess}u)" if term.excess else product


def _polynomial(
    axis: str, name: str, p: FixedPolynomial[int], form: PolynomialFormat, of: str, proof: OverflowProof
) -> Polynomial:
    coefficients = [Coefficient(p.constant, form.places, "")]
    for index, (part, shape) in enumerate(zip(p.powers, form.powers, strict=True), start=1):
        factors = f"c[{index}], {of}->x_{part.power}"
        text = {
            1: f"floored(c[{index}] * floored({of}->x_{part.power}, 16u), {part.shift}u)",
            2: f"floored(scaled_short({factors}), {part.shift}u)",
            3: f"{2**part.shift} * scaled({factors})" if part.shift else f"scaled({factors})",
        }[part.products]
        coefficients.append(Coefficient(part.coefficient, shape.places, text))
    return Polynomial(
        name=name,
        unit=UNITS.get(name[0], "V"),
        places=form.places,
        range=proof.ranges[f"{axis}.{name}"],
        of=of,
        coefficients=tuple(coefficients),
    )


def _voltage_limits(table: ControllerTable, law: FixedLaw[int]) -> list[tuple[str, int, float]]:
    rows = []
    for axis, own in ((law.elevation, table.elevation), (law.azimuth, table.azimuth)):
        _, prefix = PREFIXES[axis.name]
        rows += [
            (f"{prefix}_MIN_V", axis.u_min_V, own.u_min_V),
            (f"{prefix}_MAX_V", axis.u_max_V, own.u_max_V),
            (f"{prefix}_SAFE_V", axis.u_safe_V, own.u_safe_V),
        ]
    return rows


def _angle_limits(table: ControllerTable, law: FixedLaw[int], formats: LawFormats) -> list[tuple[str, int, str]]:
    limit_rad = formats.angle_limit_rad
    rows = [
        ("PSI_REF_MIN_RAD", law.elevation.reference_min_rad, table.elevation.reference_min_rad),
        ("PSI_REF_MAX_RAD", law.elevation.reference_max_rad, table.elevation.reference_max_rad),
        ("PHI_REF_MIN_RAD", law.azimuth.reference_min_rad, table.azimuth.reference_min_rad),
        ("PHI_REF_MAX_RAD", law.azimuth.reference_max_rad, table.azimuth.reference_max_rad),
        ("PSI_MIN_RAD", law.psi_min_rad, table.psi_min_rad),
        ("PSI_MAX_RAD", law.psi_max_rad, table.psi_max_rad),
        ("ANGLE_LIMIT_RAD", law.angle_max_rad, limit_rad),
    ]
    return [(name, word, f"{value:.9g}") for name, word, value in rows]
