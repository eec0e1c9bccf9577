"""A controller's table -> C text: the frame's header and body around the controller's own template. Pure."""

from collections.abc import Mapping
from dataclasses import fields
from functools import cache, reduce
from typing import Any, get_type_hints

import jinja2

from codegen.law import c_environment, frame_axis, frame_context, region_text, shared_context, test_context
from codegen.law_frame import AxisEquations, without_vanishing_powers
from codegen.law_terms import array_name
from codegen.numbers import c_float32
from codegen.self_test import self_test
from controllers.equations.exact import EquationTwin
from controllers.equations.frame import float32_polynomial
from records.law_table import LawTable
from records.table import Polynomial


def generate(table: LawTable[Any], equations: AxisEquations, template: str) -> Mapping[str, str]:
    """C texts by file name: law.h, law.c and law_self_test.c; `template` is a file of controllers/templates for law.c."""
    gains = table.axes[0].gains
    feedforwards = {
        array_name(loop, "u_ff_V"): float32_polynomial(axis.feedforward_V)
        for loop, axis in zip(table.loops, table.axes, strict=True)
        if without_vanishing_powers(axis.feedforward_V)
    }
    polynomials = [entry for rows in _polynomials(gains).values() for entry in rows]
    degrees = {len(entry) - 1 for entry in (*feedforwards.values(), *polynomials)}
    axes = tuple(frame_axis(table, loop) for loop in table.loops)
    names = [field.name for field in fields(equations.AxisState)]  # type: ignore[arg-type]
    context = {
        **shared_context(table, "float32"),
        **frame_context(axes, names),
        "powers": list(range(4)),
        "feedforwards": feedforwards,
        "region": region_text(table),
        "rest": {axis.name: _at_rest(axis.feedforward, table) for axis in axes},
        "degrees": sorted(degrees - {0}),
        "is_scheduled": any(len(entry) > 1 for entry in polynomials),
        "at": _values(gains),
        "gain_fields": [(field.name, _shape(getattr(gains, field.name))) for field in fields(gains)],
        **test_context(table, self_test(table, EquationTwin(equations, table))),
    }
    templates = {"law.h": "law.h.j2", "law.c": template, "law_self_test.c": "law_self_test.c.j2"}
    return {name: _environment().get_template(file).render(context) for name, file in templates.items()}


def tunable_law(texts: Mapping[str, str], template: str) -> Mapping[str, str]:
    """The same texts with gains that are no constants, and behind them law_tune of `template`, which sets them: for tuning alone."""
    tables = ("axis_gains", "fuzzy_set")
    law = reduce(lambda text, name: text.replace(f"static const {name} ", f"static {name} "), tables, texts["law.c"])
    return {**texts, "law.c": law + _environment().get_template(template).render()}


@cache
def _environment() -> jinja2.Environment:
    environment = c_environment(jinja2.PackageLoader("controllers", "templates"))
    environment.globals["initialiser"] = initialiser
    return environment


def initialiser(value: Any) -> str:
    """A number, or a tuple of whatever depth, as a C initialiser."""
    if isinstance(value, tuple):
        return "{" + ", ".join(initialiser(entry) for entry in value) + "}"
    return c_float32(value)


_ROWS = tuple[Polynomial, ...]


def _polynomials(gains: Any) -> dict[str, tuple[Polynomial, ...]]:
    """The gains that are declared as a polynomial in the scheduling output, or as rows of such, each as its rows."""
    kinds = get_type_hints(type(gains))
    found = {name: getattr(gains, name) for name, kind in kinds.items() if kind in (Polynomial, _ROWS)}
    return {name: value if kinds[name] == _ROWS else (value,) for name, value in found.items()}


def _values(gains: Any) -> dict[str, Any]:
    """Their C expressions at `schedule_rad`, a list where there are rows."""
    kinds = get_type_hints(type(gains))
    return {
        name: [_value(f"{name}[{index}]", row) for index, row in enumerate(rows)]
        if kinds[name] == _ROWS
        else _value(name, rows[0])
        for name, rows in _polynomials(gains).items()
    }


def _value(name: str, coefficients: Polynomial) -> str:
    degree = len(coefficients) - 1
    return f"polynomial_{degree}(gains->{name}, schedule_rad)" if degree else f"gains->{name}[0]"


def _at_rest(feedforward: str, table: LawTable[Any]) -> str:
    """The C expression of the feed-forward where the scheduling output is."""
    return feedforward if table.schedule is None else feedforward.replace(region_text(table), "schedule_rad")


def _shape(value: Any) -> str:
    """The C dimensions of a gain: "" for a number, "[4][3]" for a tuple of tuples, the longest of which has 3."""
    if not (isinstance(value, tuple) and value):
        return ""
    return f"[{len(value)}]{max(map(_shape, value), key=lambda inner: (len(inner), inner))}"
