"""A plant with some of its axes held mechanically: they become constants at the angle at which they are held."""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import sympy

from sim.model import Axis, Model


def locked_model(model: Model, held: Mapping[str, float]) -> Model:
    """The model with the axes `held` (name -> position) as no states: their velocities are 0, their outputs gone."""
    return _locked(model, tuple(sorted(held.items())))


@lru_cache(maxsize=64)
def _locked(model: Model, held: tuple[tuple[str, float], ...]) -> Model:
    constants: dict[sympy.Symbol, sympy.Expr] = {}
    for axis in model.axes:
        if axis.name in dict(held):
            constants[axis.velocity] = sympy.Integer(0)
            if axis.position is not None:
                constants[axis.position] = sympy.Float(dict(held)[axis.name])
    outputs = {
        name: expression
        for name, expression in model.outputs.items()
        if not (expression.free_symbols and expression.free_symbols <= set(constants))
    }
    axes = tuple(axis_beside(axis, constants) for axis in model.axes if axis.name not in dict(held))
    return Model(
        name=f"{model.name}_locked",
        states=tuple(state for state in model.states if state not in constants),
        inputs=model.inputs,
        outputs={name: sympy.sympify(expression).subs(constants) for name, expression in outputs.items()},
        parameters=model.parameters,
        rates={state: sympy.sympify(r).subs(constants) for state, r in model.rates.items() if state not in constants},
        axes=axes,
        input_limits=model.input_limits,
    )


def axis_beside(axis: Axis, constants: Mapping[sympy.Symbol, sympy.Expr | int]) -> Axis:
    """An axis that moves while the states `constants` are held."""
    inertia, torque, coulomb = (
        sympy.sympify(term).subs(constants) for term in (axis.inertia, axis.torque, axis.coulomb)
    )
    return replace(axis, inertia=inertia, torque=torque, coulomb=coulomb)
