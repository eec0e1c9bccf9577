"""From a constant of the C text back to what it was made from: table, fit, operating points, poles, plant parameters, sources.

The sensitivity of a designed coefficient to a parameter is d ln(coefficient) / d ln(parameter) at the operating point nearest to
level, by central differences of the whole design: the parameters that it names are those that the coefficient rests on.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.polynomial import polyval

from codegen.traceability.names import Constant, constants, find_constant, identity
from design.operating_points import design_point, rest, rest_V
from design.settings import DesignSettings
from records.errors import BadInput
from records.plant import Parameter, plant_digest
from records.table import ControllerTable
from sim.bind import BoundPlant

_STEP = 1e-4
_LEAST_SENSITIVITY = 1e-6


@dataclass(frozen=True)
class PointTrace:
    """One operating point, `at` which value of the schedule, the `inputs` at rest: what was designed there and what the fit gives."""

    at: float
    inputs: tuple[float, ...]
    designed: float
    fitted: float


@dataclass(frozen=True)
class ParameterTrace:
    """A plant parameter behind a constant; `sensitivity` is relative, None where the constant is the parameter itself."""

    name: str
    value: float
    sd: float
    unit: str
    source: str
    sensitivity: float | None = None


@dataclass(frozen=True)
class Trace:
    """Where a constant of the C comes from, in the order from the C back to the plant.

    `schedule` is the column that the points lie along, empty without a schedule, `inputs` are those of the points.
    """

    name: str
    c_text: str
    value: float
    unit: str
    made_as: str
    polynomial: tuple[float, ...]
    schedule: str
    inputs: tuple[str, ...]
    points: tuple[PointTrace, ...]
    poles_rad_s: tuple[tuple[float, float], ...]
    free_degree: str | None
    parameters: tuple[ParameterTrace, ...]
    plant: str
    plant_digest: str
    table_digest: str


def trace(
    bound: BoundPlant, settings: DesignSettings, table: ControllerTable, name: str, arithmetic: str = "float32"
) -> Trace:
    """The trace of the constant `name`; raises BadInput for a name that the C does not have, or a table without its origin."""
    constant = find_constant(table, name, arithmetic)
    origin = table.origin
    if "operating_points" not in origin:
        what = "no record of operating points"
        raise BadInput(
            "origin", f"controller table {table.digest[:16]}", what, "a designed table", "run `twinlaw design`"
        )
    _refuse_another_plant(bound, table)
    points = tuple(_points(table, constant))
    own = origin[constant.axis] if constant.letter in ("q", "p") else {}
    return Trace(
        name=constant.name,
        c_text=constant.literal.text,
        value=constant.value,
        unit=constant.unit,
        made_as=constant.made_as,
        polynomial=constant.polynomial,
        schedule=_schedule(table),
        inputs=tuple(loop.input for loop in table.loops),
        points=points,
        poles_rad_s=tuple((pole[0], pole[1]) for pole in own.get("poles_rad_s", ())),
        free_degree=own.get("free_degree"),
        parameters=tuple(_parameters(bound, settings, constant, points)),
        plant=table.plant,
        plant_digest=str(origin["plant_digest"]),
        table_digest=table.digest,
    )


def names(table: ControllerTable, arithmetic: str = "float32") -> tuple[Constant, ...]:
    """Every constant that can be traced, in the order of the C text."""
    return (*constants(table, arithmetic), *identity(table, arithmetic))


def _points(table: ControllerTable, constant: Constant) -> Iterator[PointTrace]:
    """What was designed at each operating point for the polynomial that holds the constant."""
    if constant.letter not in ("q", "p", "u_ff"):
        return
    angle = _schedule(table)
    for index, point in enumerate(table.origin["operating_points"]):
        psi_rad = point.get(angle, 0.0)
        fitted = float(polyval(psi_rad, constant.polynomial))
        yield PointTrace(psi_rad, tuple(point["u0_V"]), _designed(table, constant, index), fitted)


def _schedule(table: ControllerTable) -> str:
    return "" if table.schedule is None else table.loops[table.index(table.schedule.axis)].output


def _designed(table: ControllerTable, constant: Constant, point: int) -> float:
    origin = table.origin
    if constant.letter == "u_ff":
        return float(origin["operating_points"][point]["u0_V"][table.index(constant.axis)])
    own = table.loops[table.index(constant.axis)].own
    group = own("q_V_rad") if constant.letter == "q" else "p"
    return float(origin[constant.axis][group][point][constant.index])


def _parameters(
    bound: BoundPlant, settings: DesignSettings, constant: Constant, points: tuple[PointTrace, ...]
) -> Iterator[ParameterTrace]:
    """The parameters that the constant is, or rests on, the most influential first."""
    if constant.parameter is not None:
        yield _told(bound.plant.parameters[constant.parameter], constant.parameter, None)
    if not points:
        return
    psi_rad = min((point.at for point in points), key=abs)
    found = []
    for index, (name, parameter, element) in enumerate(_entries(bound)):
        slope = _sensitivity(bound, settings, constant, psi_rad, index)
        if abs(slope) > _LEAST_SENSITIVITY:
            found.append(_told(parameter, name, slope, element))
    yield from sorted(found, key=lambda entry: -abs(entry.sensitivity or 0.0))


def _entries(bound: BoundPlant) -> list[tuple[str, Parameter, int]]:
    """A name, its parameter and the place in it for each number of the vector `bound.p`, those of effects left out."""
    entries: list[tuple[str, Parameter, int]] = []
    for spec in bound.model.parameters:
        parameter = bound.plant.parameters.get(spec.name)
        if parameter is not None:
            count = len(parameter.values)
            entries += [(f"{spec.name}[{i}]" if count > 1 else spec.name, parameter, i) for i in range(count)]
    return entries


def _sensitivity(bound: BoundPlant, settings: DesignSettings, constant: Constant, psi_rad: float, index: int) -> float:
    if bound.p[index] == 0.0:
        return 0.0
    low, high = (_design_at(bound, settings, constant, psi_rad, index, 1.0 + step) for step in (-_STEP, _STEP))
    middle = 0.5 * (low + high)
    return (high - low) / (2.0 * _STEP * middle) if middle else 0.0


def _design_at(
    bound: BoundPlant, settings: DesignSettings, constant: Constant, psi_rad: float, index: int, factor: float
) -> float:
    """The designed coefficient, or voltage, of a plant whose parameter `index` is multiplied by `factor`."""
    p = np.array(bound.p)
    p[index] *= factor
    changed = replace(bound, p=p)
    point, axis = rest(changed, settings, psi_rad), constant.axis
    if constant.letter == "u_ff":
        return float(rest_V(changed, [point], settings.loop(axis))[0])
    delta = design_point(changed, point, settings, settings.axis(axis), psi_rad).delta
    return float((delta.q if constant.letter == "q" else delta.p)[constant.index])


def _told(parameter: Parameter, name: str, sensitivity: float | None, element: int = 0) -> ParameterTrace:
    value, sd, unit = parameter.values[element], parameter.sds[element], parameter.units[element]
    return ParameterTrace(name, value, sd, unit, parameter.source, sensitivity)


def _refuse_another_plant(bound: BoundPlant, table: ControllerTable) -> None:
    """A table that was designed on other numbers has other reasons than these."""
    digest = plant_digest(bound.plant)
    known = str(table.origin["plant_digest"])
    if digest != known:
        got, expected = f"{bound.plant.name!r}, digest {digest[:16]}", f"{table.plant!r}, digest {known[:16]}"
        raise BadInput(
            "plant",
            f"table {table.digest[:16]}",
            got,
            expected,
            "give the plant that the table was designed on, with --plant",
        )
