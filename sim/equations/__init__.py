"""A plant's record in; its nominal equations out: those of the project's table, or those that a file beside the plant file states."""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import sympy

from records.errors import BadInput
from records.plant import Equations, Plant
from sim.equations.check import check_model
from sim.equations.own_file import run_file
from sim.equations.pace import at_its_pace
from sim.model import Axis, Model
from sim.plants import MODELS


def nominal_model(plant: Plant) -> Model:
    """The equations without effects: the same object for the same plant. Raises BadInput, of a file of one's own with the line."""
    return at_its_pace(_stated(plant), plant)


def _stated(plant: Plant) -> Model:
    if plant.equations is not None:
        return _own(plant.equations)
    if plant.model not in MODELS:
        remedy = 'name a model that exists, or write equations = "NAME.py" for a file of your own'
        raise BadInput("model", f"plant {plant.name!r}", repr(plant.model), f"one of {', '.join(MODELS)}", remedy)
    return MODELS[plant.model]()


@lru_cache(maxsize=64)
def _own(equations: Equations) -> Model:
    model = run_file(equations)
    check_model(model, equations)
    return _in_symbols(model)


def _in_symbols(model: Model) -> Model:
    """The model with every expression SymPy's, also where a plain number stood; without inputs nothing is in a loop."""

    def named(expressions: Mapping[Any, Any]) -> dict[Any, sympy.Expr]:
        return {name: sympy.sympify(expression) for name, expression in expressions.items()}

    places = model.places.edited(sympy.sympify)
    return replace(
        model,
        rates=named(model.rates),
        outputs=named(model.outputs),
        signals=named(model.signals),
        axes=tuple(_axis_in_symbols(axis) for axis in model.axes),
        places=replace(places, loop=places.loop and bool(model.inputs)),
    )


def _axis_in_symbols(axis: Axis) -> Axis:
    parts: dict[str, Any] = {name: sympy.sympify(getattr(axis, name)) for name in ("inertia", "torque", "coulomb")}
    stops = {name: getattr(axis, name) for name in ("lower", "upper")}
    parts |= {name: None if stop is None else sympy.sympify(stop) for name, stop in stops.items()}
    return replace(axis, **parts)
