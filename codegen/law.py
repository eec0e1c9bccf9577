"""Controller table -> C text of the law, its header and its self-test. Pure: the same table gives the same bytes."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Any

import jinja2
import numpy as np

from codegen.fixed.context import fixed_context
from codegen.fixed.twin import FixedTwin
from codegen.law_equations import axis_state
from codegen.law_frame import last_accepted, schedule_ranges, without_vanishing_powers
from codegen.law_terms import Names, array_name, coefficient_unit, coefficients
from codegen.numbers import c_float32
from codegen.operations import operation_count
from codegen.self_test import SelfTest, self_test
from codegen.twin import PWM_TICKS, Float32Twin
from records.errors import BadInput
from records.law_table import FlownTable
from records.loops import Loop, full_scale_words, full_scales_V
from records.table import LEAST_SCHEDULE_RAD, PLAUSIBLE_V, AxisLaw, ControllerTable, Polynomial
from records.text.units import unit_of

ARITHMETIC_CODES = {"float32": 0, "fixed": 1}


@dataclass(frozen=True)
class Array:
    """A table of coefficients in the C text."""

    name: str
    coefficients: Polynomial
    unit: str
    range: str


@dataclass(frozen=True)
class FloatTerm:
    """One product of the move of v: its sign, its coefficient's name and expression, and what it multiplies."""

    sign: str
    coefficient: str
    value: str
    factor: str


@dataclass(frozen=True)
class FloatAxis:
    """One axis as the template sees it: its names, its numbers in the table, and the C expressions made of them."""

    loop: Loop
    angle: str
    angle_unit: str
    voltage: str
    voltage_unit: str
    suffix: str
    numbers: Any
    filter: str
    prefilter_gain: float
    prefilter_time_constant_s: float
    feedforward: str
    terms: tuple[FloatTerm, ...]

    @property
    def name(self) -> str:
        """The loop's."""
        return self.loop.axis

    @property
    def scheduled(self) -> bool:
        """True when any coefficient varies with the scheduling angle."""
        return any("schedule_rad" in term.value for term in self.terms)


@dataclass(frozen=True)
class ScheduleNames:
    """The scheduling angle as the template sees it: its axis, its symbol, the prefix of its limits and their unit, and these."""

    axis: str
    symbol: str
    output: str
    angle: str
    angle_unit: str
    min_rad: float
    max_rad: float


def demand_drivable(table: FlownTable) -> None:
    """Raise BadInput for a loop whose voltages its driver on the board cannot give: beyond full scale, never 0 V, or of the wrong sign."""
    for loop, axis in zip(table.loops, table.axes, strict=True):
        if loop.pins is None:
            continue
        scale_V = loop.full_scale_V
        least_V = 0.0 if loop.pins.direction is None else -scale_V
        if not (least_V <= axis.u_min_V and axis.u_max_V <= scale_V and axis.u_safe_V == 0.0):
            unit, own = unit_of(loop.input), loop.own
            got = f"{axis.u_min_V:g} to {axis.u_max_V:g} {unit}, {axis.u_safe_V:g} {unit} at rest"
            expected = f"{least_V:g} to {scale_V:g} {unit} with 0 {unit} among them: full scale of its PWM"
            remedy = (
                f"narrow {own('u_min_V')} and {own('u_max_V')} in its section of [design], "
                f"or name a direction or {own('full_scale_V')} in [board]"
            )
            raise BadInput(f"values of {loop.input}", f"loop {loop.axis} on {loop.pins.pwm}", got, expected, remedy)


def generate_law(table: ControllerTable, arithmetic: str = "float32") -> dict[str, str]:
    """C texts by file name: law.h, law.c and law_self_test.c.

    Raises BadInput for an unknown arithmetic, and for a table whose law could not run in it (codegen/law_constants.py).
    """
    if arithmetic not in ARITHMETIC_CODES:
        known = " or ".join(ARITHMETIC_CODES)
        raise BadInput("arithmetic", "generate", arithmetic, known, "choose one of these with --arithmetic")
    return dict(_generated(_Digested(table.digest, table), arithmetic))


@dataclass(frozen=True)
class _Digested:
    """A table that is another's equal where its digest, which is of all its content, is."""

    digest: str
    table: ControllerTable = field(compare=False)


@lru_cache(maxsize=32)  # the self-test runs the twin in Python, which takes longer than all else here
def _generated(of: _Digested, arithmetic: str) -> dict[str, str]:
    context = shared_context(of.table, arithmetic) | _CONTEXTS[arithmetic](of.table)
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
        "full_scale_note": " and ".join(full_scale_words(table.loops)),
        "duty_names": _duty_names(full_scales_V(table.loops)),
        "loops": table.loops,
        "units": _units(table.loops),
        "whose": {1: f"the {table.loops[0].axis}", 2: "both axes"}.get(len(table.loops), "all axes"),
        "schedule": _schedule_names(table),
        "last_accepted_fields": last_accepted(table.loops),
    }


def _units(loops: tuple[Loop, ...]) -> dict[str, str]:
    """The units of all outputs and of all inputs, as comments say them."""
    columns = {"output": [loop.output for loop in loops], "input": [loop.input for loop in loops]}
    return {
        what: " and ".join(dict.fromkeys(unit_of(name) or "1" for name in names)) for what, names in columns.items()
    }


def _duty_names(scales_V: tuple[float, ...]) -> dict[float, str]:
    """The function of the C text that makes ticks of volts, by full scale."""
    return {scale_V: "duty" if len(scales_V) == 1 else f"duty_{place}" for place, scale_V in enumerate(scales_V, 1)}


def _schedule_names(table: FlownTable) -> ScheduleNames | None:
    schedule = table.schedule
    if schedule is None:
        return None
    loop = table.loops[table.index(schedule.axis)]
    return ScheduleNames(
        loop.axis,
        loop.symbol,
        loop.output,
        Names(loop).angle,
        Names(loop).angle_unit,
        schedule.min_rad,
        schedule.max_rad,
    )


def test_context(table: FlownTable, test: SelfTest) -> dict[str, Any]:
    """What law_self_test.c.j2 takes besides."""
    return {"test": test, "tested": list(zip(table.loops, test.loops, strict=True))}


def frame_context(axes: Sequence[FloatAxis], axis_state_fields: Sequence[str]) -> dict[str, Any]:
    """What law_frame.c.j2 takes of the table of any float32 law."""
    return {
        "plausible_V": PLAUSIBLE_V,
        "least_schedule_rad": LEAST_SCHEDULE_RAD,
        "axis_state_fields": axis_state_fields,
        "axis_state_note": "",
        "axes": axes,
        "filters": {axis.filter for axis in axes},
    }


def _float32_context(table: ControllerTable) -> dict[str, Any]:
    count = operation_count(table)  # refuses an unusable table before anything is made from it
    arrays = tuple(array for loop in table.loops for array in _arrays(table, loop))
    axes = tuple(frame_axis(table, loop, tuple(_terms(loop, table.axis(loop.axis)))) for loop in table.loops)
    return {
        **frame_context(axes, tuple(axis_state(table.order).__dataclass_fields__)),
        "axis_state_note": "; the index is the power of delta = 1 - z^-1",
        "powers": list(range(table.order + 1)),
        "arrays": arrays,
        "degrees": sorted({len(array.coefficients) - 1 for array in arrays} - {0}),
        "operations": f"{count.products} products, {count.sums} sums a step.",
        **test_context(table, self_test(table, Float32Twin(table))),
    }


def _fixed_context(table: ControllerTable) -> dict[str, Any]:
    return {**fixed_context(table), **test_context(table, self_test(table, FixedTwin(table)))}


_CONTEXTS = {"float32": _float32_context, "fixed": _fixed_context}
_TEMPLATES = {
    "float32": {"law.h": "law.h.j2", "law.c": "law.c.j2", "law_self_test.c": "law_self_test.c.j2"},
    "fixed": {"law.h": "law_fixed.h.j2", "law.c": "law_fixed.c.j2", "law_self_test.c": "law_self_test.c.j2"},
}


def frame_axis(table: FlownTable, loop: Loop, terms: tuple[FloatTerm, ...] = ()) -> FloatAxis:
    """One axis of any float32 table as the frame's template sees it."""
    axis, names = table.axis(loop.axis), Names(loop)
    time_constant_s = axis.prefilter_time_constant_s
    return FloatAxis(
        loop=loop,
        angle=names.angle,
        angle_unit=names.angle_unit,
        voltage=names.voltage,
        voltage_unit=names.voltage_unit,
        suffix=names.suffix,
        numbers=axis,
        filter="take_reference" if time_constant_s == 0.0 else "prefilter",
        prefilter_gain=axis.prefilter_gain(table.sample_period_s),
        prefilter_time_constant_s=time_constant_s,
        feedforward=_value(array_name(loop, "u_ff_V"), axis.feedforward_V, region_text(table)),
        terms=terms,
    )


def region_text(table: FlownTable) -> str:
    """The C expression of the filtered reference of the scheduling angle, which the feed-forward is of."""
    return "0.0f" if table.schedule is None else f"self->{table.schedule.axis}.reference_2_rad"


def _terms(loop: Loop, law: AxisLaw) -> list[FloatTerm]:
    """The terms of the move in their order of summation."""
    terms = []
    for entry in coefficients(law):
        if without_vanishing_powers(entry.polynomial):
            value = _value(array_name(loop, entry.name), entry.polynomial, "schedule_rad")
            holder = "e" if entry.letter == "q" else "self"
            terms.append(FloatTerm("-" if entry.sign < 0 else "+", entry.name, value, f"{holder}->{entry.factor}"))
    return terms


def _arrays(table: ControllerTable, loop: Loop) -> list[Array]:
    law = table.axis(loop.axis)
    over_rad, reference_rad = schedule_ranges(table)
    named = [
        (array_name(loop, entry.name), entry.polynomial, coefficient_unit(loop, entry.letter), over_rad)
        for entry in coefficients(law)
    ]
    named.append((array_name(loop, "u_ff_V"), law.feedforward_V, coefficient_unit(loop, "u_ff"), reference_rad))
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
    """The text ROUNDED((ROUNDED(c[n] * x) + c[n-1]) * x) .. + c[0]."""
    text = f"c[{degree}]"
    for index in range(degree - 1, -1, -1):
        text = f"ROUNDED({text} * x) + c[{index}]"
        text = f"({text})" if index else text
    return text


def _range_text(polynomial: Polynomial, over_rad: tuple[float, float]) -> str:
    """Least and largest value on 201 points, as a reader's aid."""
    values = np.polynomial.polynomial.polyval(np.linspace(*over_rad, 201), polynomial)
    return f"{values.min():.4g}..{values.max():.4g}"
