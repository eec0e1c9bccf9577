"""A controller's table -> C text: the frame's header and body around the controller's own template. Pure."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import jinja2

from codegen.law import Axis, c_environment, shared_context
from codegen.law_equations import LAST_ACCEPTED_FIELDS
from codegen.numbers import c_float32
from codegen.self_test import self_test
from codegen.twin import FULL_SCALE_V, PWM_TICKS
from controllers.exact import EquationTwin
from controllers.frame import AxisEquations, float32_polynomial
from records.law_table import AxisTable, LawTable
from records.table import LEAST_SCHEDULE_RAD

_AXES = {"elevation": ("PSI", "U_M"), "azimuth": ("PHI", "U_T")}


def generate(table: LawTable[Any], equations: AxisEquations, template: str) -> Mapping[str, str]:
    """C texts by file name: law.h, law.c and law_self_test.c; `template` is a file of controllers/templates for law.c."""
    axes = {"elevation": table.elevation, "azimuth": table.azimuth}
    feedforwards = {name: float32_polynomial(axis.feedforward_V) for name, axis in axes.items()}
    degrees = {len(entry) - 1 for entry in (*feedforwards.values(), *_polynomials(table.elevation.gains).values())}
    context = shared_context(table, "float32") | {
        "half_ticks_per_V": 2.0 * PWM_TICKS / FULL_SCALE_V,
        "least_schedule_rad": LEAST_SCHEDULE_RAD,
        "psi_min_rad": table.psi_min_rad,
        "psi_max_rad": table.psi_max_rad,
        **axes,
        "axis_state_fields": [field.name for field in fields(equations.AxisState)],  # type: ignore[arg-type]
        "axis_state_note": "",
        "last_accepted_fields": LAST_ACCEPTED_FIELDS,
        "axes": [_axis(name, axis, table.sample_period_s) for name, axis in axes.items()],
        "filters": {_filter(axis) for axis in axes.values()},
        "feedforwards": feedforwards,
        "degrees": sorted(degrees - {0}),
        "at": _values(table.elevation.gains),
        "gain_fields": [
            (field.name, _shape(getattr(table.elevation.gains, field.name))) for field in fields(table.elevation.gains)
        ],
        "test": self_test(table, EquationTwin(equations, table)),
    }
    environment = c_environment(jinja2.PackageLoader("controllers", "templates"))
    environment.globals["initialiser"] = initialiser
    names = {"law.h": "law.h.j2", "law.c": template, "law_self_test.c": "law_self_test.c.j2"}
    return {name: environment.get_template(file).render(context) for name, file in names.items()}


def initialiser(value: Any) -> str:
    """A number, or a tuple of whatever depth, as a C initialiser."""
    if isinstance(value, tuple):
        return "{" + ", ".join(initialiser(entry) for entry in value) + "}"
    return c_float32(value)


def _polynomials(gains: Any) -> dict[str, tuple[float, ...]]:
    """The gains that are polynomials in the elevation: tuples of numbers."""
    values = {field.name: getattr(gains, field.name) for field in fields(gains)}
    return {
        name: value
        for name, value in values.items()
        if isinstance(value, tuple) and all(isinstance(entry, float) for entry in value)
    }


def _values(gains: Any) -> dict[str, str]:
    """Their C expressions at `psi_rad`."""
    return {
        name: f"polynomial_{len(value) - 1}(gains->{name}, psi_rad)" if len(value) > 1 else f"gains->{name}[0]"
        for name, value in _polynomials(gains).items()
    }


def _shape(value: Any) -> str:
    """The C dimensions of a gain: "" for a number, "[4][3]" for a tuple of tuples."""
    return f"[{len(value)}]{_shape(value[0])}" if isinstance(value, tuple) and value else ""


def _filter(axis: AxisTable[Any]) -> str:
    return "take_reference" if axis.prefilter_time_constant_s == 0.0 else "prefilter"


def _axis(name: str, axis: AxisTable[Any], sample_period_s: float) -> Axis:
    angle, voltage = _AXES[name]
    degree = len(float32_polynomial(axis.feedforward_V)) - 1
    array = f"{name}_u_ff_V"
    return Axis(
        name=name,
        angle=angle,
        voltage=voltage,
        filter=_filter(axis),
        prefilter_gain=axis.prefilter_gain(sample_period_s),
        prefilter_time_constant_s=axis.prefilter_time_constant_s,
        feedforward=f"polynomial_{degree}({array}, self->elevation.reference_2_rad)" if degree else f"{array}[0]",
        terms=(),
    )
