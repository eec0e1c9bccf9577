"""Equations that carry many effects, each behind a switch, so that they take the time of those alone that are on (symbolic/switches.py)."""

from collections.abc import Iterable
from dataclasses import replace
from functools import reduce

import sympy

from sim.edits import with_input
from sim.effect import Effect, coefficient
from sim.model import Model, ParameterSpec

INPUTS_ON = "inputs_on"


def switch_name(effect: Effect) -> str:
    """The parameter, 1 or 0, that turns an effect on; one turns on all that changes what arrives of the inputs."""
    return INPUTS_ON if effect.applied is not None else coefficient(effect.name, "on")


def switched(nominal: Model, effects: Iterable[Effect]) -> Model:
    """The model with these effects on its equations, in their order, and one parameter more for each switch.

    An effect's size becomes zero + on (size - zero), an input u + on (what arrives of it - u): nothing of either is left at on = 0.
    """
    chosen = list(effects)
    switches = [ParameterSpec(name, 1, "1") for name in dict.fromkeys(map(switch_name, chosen))]
    model = reduce(_edited, (effect for effect in chosen if effect.edit is not None), nominal)
    model = _with_inputs(model, [effect for effect in chosen if effect.applied is not None])
    specs = [spec for effect in chosen for spec in effect.specs]
    symbols = tuple(spec.symbols[0] for spec in switches)
    return replace(model, parameters=(*model.parameters, *specs, *switches), switches=symbols)


def _edited(model: Model, effect: Effect) -> Model:
    assert effect.edit is not None
    on = sympy.Symbol(switch_name(effect), real=True)
    sizes = [
        symbol if parameter.zero is None else parameter.zero + on * (symbol - parameter.zero)
        for parameter, symbol in zip(effect.parameters, effect.symbols, strict=True)
    ]
    return sleeping(model, effect.edit(model, *sizes), on)


def sleeping(before: Model, model: Model, on: sympy.Symbol) -> Model:
    """The model whose states that `before` had not stand still while the switch is 0."""
    brought = [state for state in model.states if state not in before.states]
    rates = {**model.rates, **{state: on * model.rates[state] for state in brought}}
    return replace(model, rates=rates, sleepers={**model.sleepers, **dict.fromkeys(brought, on)})


def _with_inputs(model: Model, effects: Iterable[Effect]) -> Model:
    """The model behind all these changes of its inputs: the last is the first that an input passes."""
    arrives: dict[sympy.Symbol, sympy.Expr] = {variable: variable for variable in model.inputs}
    for effect in reversed(list(effects)):
        assert effect.applied is not None
        changed = effect.applied(*effect.symbols)
        arrives |= {variable: expression.xreplace(arrives) for variable, expression in changed.items()}
    on = sympy.Symbol(INPUTS_ON, real=True)
    switchable = {u: u + on * (expression - u) for u, expression in arrives.items() if expression != u}
    return with_input(model, switchable)
