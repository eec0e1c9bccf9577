"""The same rig written otherwise: an axis counted the other way round, masses in grams, a part of the library left out.

Each is equations of one's own, a text that changes the model of the plant as it is.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import sympy

from records.log import RunLog
from records.plant import Equations, Parameter, Value
from records.text.units import dimension
from sim.bind import BoundPlant, bind
from sim.model import Axis, Model
from sim.places import RotorPlace

GRAMS = 1000.0  # of a kilogram
MODULE = "tests.diagnosis.otherwise"


def written(bound: BoundPlant, changed: str, numbers: Mapping[str, Parameter] | None = None) -> BoundPlant:
    """The plant with equations that the function `changed` of this file makes of its own."""
    own = bound.plant.equations
    plain = f"from sim.plants import MODELS\n\nmodel = MODELS[{bound.plant.model!r}]\n" if own is None else own.text
    name = f"{bound.plant.model}_{changed}"
    root = Path(__file__).parents[2]
    text = (
        f"{plain}\n\nimport sys\nfrom dataclasses import replace\n\nsys.path.insert(0, {str(root)!r})\n"
        f"from {MODULE} import {changed}\n\nplain = model\n\n\ndef model():\n    return replace({changed}(plain()), name={name!r})\n"
    )
    plant = replace(bound.plant, model=name, equations=Equations(f"{name}.py", text))
    return bind(replace(plant, parameters=plant.parameters if numbers is None else numbers))


def turned(model: Model) -> Model:
    """The equations with the first axis counted the other way round: x, v and the torque for -x, -v and minus the torque."""
    name, position, velocity = model.axes[0].name, model.axes[0].position, model.axes[0].velocity
    own = [symbol for symbol in (position, velocity, sympy.Symbol(f"sign_{name}", real=True)) if symbol is not None]

    def other(expression: sympy.Expr) -> sympy.Expr:
        return sympy.sympify(expression).subs({symbol: -symbol for symbol in own}, simultaneous=True)

    def axis(entry: Axis) -> Axis:
        said = replace(entry, inertia=other(entry.inertia), torque=other(entry.torque), coulomb=other(entry.coulomb))
        if entry.name != name:
            return said
        lower, upper = (None if end is None else -sympy.sympify(end) for end in (entry.upper, entry.lower))
        return replace(said, torque=-said.torque, lower=lower, upper=upper)

    def rotor(entry: RotorPlace) -> RotorPlace:
        return replace(entry, thrusts={to: -by if to == name else by for to, by in entry.thrusts.items()})

    places = model.places.edited(other)
    axes = {
        where: replace(entry, gravity=-entry.gravity if where == name and entry.gravity is not None else entry.gravity)
        for where, entry in places.axes.items()
    }
    return replace(
        model,
        rates={state: -other(rate) if state in own else other(rate) for state, rate in model.rates.items()},
        axes=tuple(axis(entry) for entry in model.axes),
        outputs={output: _sign(entry, other(entry)) * other(entry) for output, entry in model.outputs.items()},
        signals={signal: other(entry) for signal, entry in model.signals.items()},
        places=replace(places, axes=axes, rotors={where: rotor(entry) for where, entry in places.rotors.items()}),
    )


def _sign(before: sympy.Expr, after: sympy.Expr) -> int:
    """-1 of what turns with the axis, which a log then holds with the other sign."""
    return -1 if sympy.expand(before + after) == 0 else 1


def read_turned(bound: BoundPlant, log: RunLog) -> RunLog:
    """A log of the rig with its first axis counted the other way round."""
    axis = bound.model.axes[0]
    turns = {str(axis.velocity), str(axis.position)}
    signs = [-1.0 if str(read) in turns else 1.0 for read in bound.model.outputs.values()]
    extra = {name: -values if name in turns else values for name, values in log.extra.items()}
    return replace(log, y=log.y * signs, extra=extra)


def in_grams(model: Model) -> Model:
    """The equations of a plant whose masses, and so forces and torques, are a thousand times the numbers they were."""
    axes = {name: replace(axis, torque_size=GRAMS * axis.torque_size) for name, axis in model.places.axes.items()}
    return replace(model, places=replace(model.places, axes=axes))


def numbers_in_grams(bound: BoundPlant) -> dict[str, Parameter]:
    """The parameters of the plant, those with a mass in their unit a thousand times as large for each power of it."""
    return {name: _in_grams(entry) for name, entry in bound.plant.parameters.items()}


def _in_grams(entry: Parameter) -> Parameter:
    factors = [GRAMS ** float(dimension(unit)[0]) for unit in entry.units]

    def said(values: Value) -> Value:
        if not isinstance(values, tuple):
            return factors[0] * values
        return tuple(factor * value for factor, value in zip(factors, values, strict=True))

    return replace(entry, value=said(entry.value), sd=said(entry.sd))


def without_loop(model: Model) -> Model:
    """The equations of a plant of which nobody asks whether frames are lost on the way."""
    return replace(model, places=replace(model.places, loop=False))
