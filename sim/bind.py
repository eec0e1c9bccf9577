"""A plant file's parameters bound to the equations that it names, with the effects that it adds."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import sympy
from numpy.typing import NDArray

from records.errors import BadInput
from records.pages import page
from records.plant import Parameter, Plant
from records.text.units import dimensions
from sim.composition.build import model_with, paths_with
from sim.composition.table import Entries, plain_values, read_effects
from sim.effect import coefficient
from sim.equations import nominal_model
from sim.model import Model, ParameterSpec
from sim.paths.path import InputStage, OutputStage


@dataclass(frozen=True)
class BoundPlant:
    """Equations with numbers: `p` and `sd` are the parameter vector and its standard deviations, shape (parameters,), SI.

    `model` has the equations of the plant's `effects`, whose parameters follow the plant's own in `p`; `input_path` and `output_path`
    are the stages that its inputs and outputs pass for those effects that are no equations.
    """

    plant: Plant
    model: Model
    p: NDArray[np.float64]
    sd: NDArray[np.float64]
    effects: Entries = field(default_factory=dict)
    input_path: tuple[InputStage, ...] = ()
    output_path: tuple[OutputStage, ...] = ()

    @property
    def nominal(self) -> Model:
        """The equations without the plant's effects: the same object wherever the same plant asks."""
        return nominal_model(self.plant)

    @property
    def encoder_steps(self) -> tuple[float, ...]:
        """The sensors' resolutions (outputs,) in the order of the model's outputs, each in its output's unit; 0 where there is none."""
        return tuple(self.plant.sensors[output] for output in self.model.outputs)

    def parameter(self, name: str) -> float:
        """The value of a parameter that is one number."""
        return self.plant.parameters[name].values[0]

    def number(self, expression: sympy.Expr | float) -> float:
        """The value of an expression in the parameters alone, a stop or a limit say."""
        return evaluated(self.model, self.p, expression)

    def limits(self, variable: sympy.Symbol) -> tuple[float, float]:
        """The least and the largest value of an input."""
        low, high = self.model.limits(variable)
        return self.number(low), self.number(high)

    def commands(self, variable: sympy.Symbol) -> tuple[float, float]:
        """The limits of an input, and on a side without one the largest command that is usual at its place."""
        usual = max(
            (place.size for place in self.model.places.inputs.values() if place.variable == variable), default=1.0
        )
        low, high = self.limits(variable)
        return (low if low > -np.inf else -usual), (high if high < np.inf else usual)


def bind(plant: Plant) -> BoundPlant:
    """Check a plant's parameters against its model and put them in the model's order.

    Raises BadInput for an unknown model, a missing or unknown parameter, a wrong shape, unit or sign, a missing sensor, or an
    effect that the model cannot have.
    """
    where = f"plant {plant.name!r}"
    model = nominal_model(plant)
    _check_names(plant, model, where)
    for spec in model.parameters:
        _check_parameter(spec, plant.parameters[spec.name], f"{where}: parameters.{spec.name}")
    effects = read_effects(plant.effects, model, f"{where}: effects")
    paths = paths_with(model, plain_values(effects))
    known = {**plant.parameters, **_named(effects)}
    model = model_with(model, tuple(effects))
    ordered = [known[spec.name] for spec in model.parameters]
    p = np.array([value for entry in ordered for value in entry.values])
    sd = np.array([value for entry in ordered for value in entry.sds])
    _check_limits(model, p, where)
    _check_axes(model, p, where)
    return BoundPlant(plant, model, p, sd, effects, *paths)


def _named(effects: Entries) -> Mapping[str, Parameter]:
    """The effects' parameters by their names in the equations."""
    return {coefficient(name, symbol): entry for name, entries in effects.items() for symbol, entry in entries.items()}


def _check_names(plant: Plant, model: Model, where: str) -> None:
    known = [spec.name for spec in model.parameters]
    for name in known:
        if name not in plant.parameters:
            raise BadInput(f"parameter {name!r}", where, "nothing", "a section", f"add [parameters.{name}]")
    for name in plant.parameters:
        if name not in known:
            raise BadInput(
                f"parameter {name!r}", where, "an unknown name", f"one of {', '.join(known)}", "remove or rename it"
            )
    for output in model.outputs:
        if output not in plant.sensors:
            raise BadInput(f"sensor {output!r}", where, "nothing", "a section", f"add [sensors.{output}]")
    for sensor in plant.sensors:
        if sensor not in model.outputs:
            raise BadInput(
                f"sensor {sensor!r}",
                where,
                "an unknown name",
                f"one of {', '.join(model.outputs)}",
                "remove or rename it",
            )


def _check_parameter(spec: ParameterSpec, entry: Parameter, where: str) -> None:
    if len(entry.values) != spec.count or isinstance(entry.value, tuple) != (spec.count > 1):
        expected = "one number" if spec.count == 1 else f"a list of {spec.count} coefficients, ascending powers"
        got = f"{len(entry.values)} coefficients" if isinstance(entry.value, tuple) else "one number"
        raise BadInput("value", where, got, expected, f"see the equations in {page('theory.md')}")
    found, wanted = dimensions(entry.unit), dimensions(spec.unit)
    if found != wanted:
        raise BadInput("unit", where, repr(entry.unit), repr(spec.unit), "convert the value to that unit")
    for value in entry.values:
        if (spec.sign == "positive" and value <= 0.0) or (spec.sign == "non-negative" and value < 0.0):
            raise BadInput(
                "sign", where, repr(value), f"a {spec.sign} value", "check the sign convention of the equations"
            )


def evaluated(model: Model, p: NDArray[np.float64], expression: sympy.Expr | float) -> float:
    """The value of an expression in the parameters p (parameters,) of a model alone."""
    return float(sympy.sympify(expression).xreplace(named_values(model, p)))


def named_values(model: Model, p: NDArray[np.float64]) -> dict[sympy.Symbol, float]:
    """The parameters p (parameters,) of a model by their symbols."""
    return dict(zip(model.parameter_symbols, p.tolist(), strict=True))


def _check_limits(model: Model, p: NDArray[np.float64], where: str) -> None:
    for variable, (lower, upper) in model.input_limits.items():
        low, high = evaluated(model, p, lower), evaluated(model, p, upper)
        if low >= high:
            got, expected = f"from {low:g} to {high:g}, of ({lower}, {upper})", "the least value, then a larger one"
            raise BadInput(f"limits of {variable}", where, got, expected, "exchange them, or widen the range")


def _check_axes(model: Model, p: NDArray[np.float64], where: str) -> None:
    """Inertia and dry friction where parameters alone give them, and stops, are those of a body."""
    known = set(model.parameter_symbols)
    for axis in model.axes:
        for part, least, expected in (("inertia", 0.0, "above 0"), ("coulomb", -np.nextafter(0.0, 1.0), "0 or more")):
            expression = sympy.sympify(getattr(axis, part))
            if expression.free_symbols <= known and not evaluated(model, p, expression) > least:
                got = f"{evaluated(model, p, expression):g}, of {expression}"
                raise BadInput(f"{part} of axis {axis.name!r}", where, got, f"a number {expected}", "check its sign")
        if axis.lower is not None and axis.upper is not None:
            low, high = evaluated(model, p, axis.lower), evaluated(model, p, axis.upper)
            if low >= high:
                got, expected = f"{low:g} below and {high:g} above", "the lower stop, then the upper one"
                raise BadInput(f"stops of axis {axis.name!r}", where, got, expected, "exchange them")
