"""Controller table -> C text of the law, its header and its self-test. Pure: the same table gives the same bytes."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Any

import jinja2
import numpy as np

from codegen.fixed.context import fixed_context
from codegen.fixed.twin import FixedTwin
from codegen.law_equations import AXIS_STATE_FIELDS, LAST_ACCEPTED_FIELDS
from codegen.law_frame import without_vanishing_powers
from codegen.law_terms import PREFIXES, UNITS, array_name, coefficients
from codegen.numbers import c_float32
from codegen.operations import operation_count
from codegen.self_test import self_test
from codegen.twin import FULL_SCALE_V, PWM_TICKS, Float32Twin
from records.errors import BadInput
from records.law_table import FlownTable
from records.table import AXES, LEAST_SCHEDULE_RAD, PLAUSIBLE_V, AxisLaw, ControllerTable, Polynomial

ARITHMETIC_CODES = {"float32": 0, "fixed": 1}


@dataclass(frozen=True)
class Array:
    """A table of coefficients in the C text."""

    name: str
    coefficients: Polynomial
    unit: str
    range: str


@dataclass(frozen=True)
class Term:
    """One product of the move of v: its sign, its coefficient's name and expression, and what it multiplies."""

    sign: str
    coefficient: str
    value: str
    factor: str


@dataclass(frozen=True)
class Axis:
    """One axis as the template sees it; `angle` and `voltage` are the prefixes of its limits in law.h."""

    name: str
    angle: str
    voltage: str
    filter: str
    prefilter_gain: float
    prefilter_time_constant_s: float
    feedforward: str
    terms: tuple[Term, ...]

    @property
    def scheduled(self) -> bool:
        """True when any coefficient varies with psi."""
        return any("schedule_rad" in term.value for term in self.terms)


def generate_law(table: ControllerTable, arithmetic: str = "float32") -> dict[str, str]:
    """C texts by file name: law.h, law.c and law_self_test.c.

    Raises BadInput for an unknown arithmetic, and for a table whose law could not run in it (codegen/law_constants.py).
    """
    if arithmetic not in ARITHMETIC_CODES:
        known = " or ".join(ARITHMETIC_CODES)
        raise BadInput("arithmetic", "generate", arithmetic, known, "choose one of these with --arithmetic")
    return dict(_texts(_Named(table.digest, table), arithmetic))


@dataclass(frozen=True)
class _Named:
    """A table that is known by its digest, which covers all of it."""

    digest: str
    table: ControllerTable = field(compare=False)


@lru_cache(maxsize=16)  # the self-test's expected results are computed step by step, and several stages ask for one law
def _texts(named: _Named, arithmetic: str) -> dict[str, str]:
    context = shared_context(named.table, arithmetic) | _CONTEXTS[arithmetic](named.table)
    templates = _TEMPLATES[arithmetic]
    return {name: _environment().get_template(template).render(context) for name, template in templates.items()}


@cache
def _environment() -> jinja2.Environment:
    """Those of this stage alone; a template is compiled once, which takes longer than to render it."""
    return c_environment()


def c_environment(*loaders: jinja2.BaseLoader) -> jinja2.Environment:
    """Templates of C: those of this stage and of further `loaders`; what is undefined is an error."""
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([*loaders, jinja2.PackageLoader("codegen", "templates")]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    environment.globals.update(number=c_float32, hexadecimal=lambda word: f"0x{word:08X}u", horner=_horner)
    return environment


def shared_context(table: FlownTable, arithmetic: str) -> dict[str, Any]:
    """What the templates of every law and arithmetic take."""
    return {
        "arithmetic": arithmetic,
        "arithmetic_code": ARITHMETIC_CODES[arithmetic],
        "digest": table.digest,
        "digest_bytes": [f"0x{byte:02X}" for byte in bytes.fromhex(table.digest)],
        "plant": table.plant,
        "sample_period_us": round(table.sample_period_s * 1e6),
        "pwm_ticks": PWM_TICKS,
        "full_scale_V": FULL_SCALE_V,
    }


def frame_context(table: Any, axes: Sequence[Axis], axis_state_fields: Sequence[str]) -> dict[str, Any]:
    """What law_frame.c.j2 takes of the table of any float32 law."""
    return {
        "half_ticks_per_V": 2.0 * PWM_TICKS / FULL_SCALE_V,
        "plausible_V": PLAUSIBLE_V,
        "least_schedule_rad": LEAST_SCHEDULE_RAD,
        "psi_min_rad": table.psi_min_rad,
        "psi_max_rad": table.psi_max_rad,
        "elevation": table.elevation,
        "azimuth": table.azimuth,
        "axis_state_fields": axis_state_fields,
        "axis_state_note": "",
        "last_accepted_fields": LAST_ACCEPTED_FIELDS,
        "axes": axes,
        "filters": {axis.filter for axis in axes},
    }


def _float32_context(table: ControllerTable) -> dict[str, Any]:
    count = operation_count(table)  # refuses an unusable table before anything is made from it
    arrays = tuple(array for name in AXES for array in _arrays(table, name))
    axes = tuple(frame_axis(table, name, tuple(_terms(name, table.axis(name)))) for name in AXES)
    return frame_context(table, axes, AXIS_STATE_FIELDS) | {
        "axis_state_note": "; the index is the power of delta = 1 - z^-1",
        "arrays": arrays,
        "degrees": sorted({len(array.coefficients) - 1 for array in arrays} - {0}),
        "operations": f"{count.products} products, {count.sums} sums a step.",
        "test": self_test(table, Float32Twin(table)),
    }


def _fixed_context(table: ControllerTable) -> dict[str, Any]:
    return {**fixed_context(table), "test": self_test(table, FixedTwin(table))}


_CONTEXTS = {"float32": _float32_context, "fixed": _fixed_context}
_TEMPLATES = {
    "float32": {"law.h": "law.h.j2", "law.c": "law.c.j2", "law_self_test.c": "law_self_test.c.j2"},
    "fixed": {"law.h": "law_fixed.h.j2", "law.c": "law_fixed.c.j2", "law_self_test.c": "law_self_test.c.j2"},
}


def frame_axis(table: Any, name: str, terms: tuple[Term, ...] = ()) -> Axis:
    """One axis of any float32 table as the frame's template sees it."""
    axis = table.axis(name)
    angle, voltage = PREFIXES[name]
    time_constant_s = axis.prefilter_time_constant_s
    return Axis(
        name=name,
        angle=angle,
        voltage=voltage,
        filter="take_reference" if time_constant_s == 0.0 else "prefilter",
        prefilter_gain=axis.prefilter_gain(table.sample_period_s),
        prefilter_time_constant_s=time_constant_s,
        feedforward=_value(array_name(name, "u_ff_V"), axis.feedforward_V, "self->elevation.reference_2_rad"),
        terms=terms,
    )


def _terms(name: str, law: AxisLaw) -> list[Term]:
    """The terms of the move in their order of summation."""
    terms = []
    for entry in coefficients(law):
        if without_vanishing_powers(entry.polynomial):
            value = _value(array_name(name, entry.name), entry.polynomial, "schedule_rad")
            holder = "e" if entry.letter == "q" else "self"
            terms.append(Term("-" if entry.sign < 0 else "+", entry.name, value, f"{holder}->{entry.factor}"))
    return terms


def _arrays(table: ControllerTable, name: str) -> list[Array]:
    law = table.axis(name)
    psi_rad = (table.psi_min_rad, table.psi_max_rad)
    named = [(array_name(name, entry.name), entry.polynomial, entry.unit, psi_rad) for entry in coefficients(law)]
    reference_rad = (table.elevation.reference_min_rad, table.elevation.reference_max_rad)
    named.append((array_name(name, "u_ff_V"), law.feedforward_V, UNITS["u_ff"], reference_rad))
    return [
        Array(array, without_vanishing_powers(polynomial), unit, _range_text(polynomial, over_rad))
        for array, polynomial, unit, over_rad in named
        if without_vanishing_powers(polynomial)
    ]


def _value(array: str, polynomial: Polynomial, x: str) -> str:
    """C expression of the polynomial stored in `array`, at x."""
    degree = len(without_vanishing_powers(polynomial)) - 1
    if degree < 0:
        return c_float32(0.0)
    return f"{array}[0]" if degree == 0 else f"polynomial_{degree}({array}, {x})"


def _horner(degree: int) -> str:
    """The text ((c[n] * x + c[n-1]) * x ...) + c[0]."""
    text = f"c[{degree}]"
    for index in range(degree - 1, -1, -1):
        text = f"({text} * x + c[{index}])" if index else f"{text} * x + c[0]"
    return text


def _range_text(polynomial: Polynomial, over_rad: tuple[float, float]) -> str:
    """Least and largest value on 201 points, as a reader's aid."""
    values = np.polynomial.polynomial.polyval(np.linspace(*over_rad, 201), polynomial)
    return f"{values.min():.4g}..{values.max():.4g}"
