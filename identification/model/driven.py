"""Which states only the inputs drive: they need no start of their own in each window of a run."""

from functools import lru_cache

import sympy

from sim.model import TIME, Model
from sim.places import Places


@lru_cache(maxsize=64)
def driven_states(model: Model) -> tuple[sympy.Symbol, ...]:
    """States off the axes whose rates depend on inputs, parameters, time and one another alone, and that forget their start.

    A rate that does not fall with its own state (an integrator) keeps its start for ever; such a state is not among them.
    """
    found = [state for state in model.rates if _forgets(model.rates[state], state) or _second(model, state)]
    while True:
        known = {TIME, *found, *model.inputs, *model.parameter_symbols}
        kept = [state for state in found if sympy.sympify(model.rates[state]).free_symbols <= known]
        if kept == found:
            return tuple(state for state in model.states if state in kept)
        found = kept


def _forgets(rate: sympy.Expr, state: sympy.Symbol) -> bool:
    return state in sympy.sympify(rate).free_symbols


def _second(model: Model, state: sympy.Symbol) -> bool:
    """A state whose rate is another state that pulls it back: the first of a filter's pair."""
    rate = sympy.sympify(model.rates[state])
    return rate in model.rates and state in sympy.sympify(model.rates[rate]).free_symbols


@lru_cache(maxsize=64)
def driven_model(model: Model) -> Model | None:
    """The driven states as a model of their own, whose outputs are all of them; None where there are none."""
    states = driven_states(model)
    if not states:
        return None
    rates = {state: model.rates[state] for state in states}
    used = set().union(*(sympy.sympify(rate).free_symbols for rate in rates.values()))
    inputs = tuple(variable for variable in model.inputs if variable in used)
    limits = {variable: model.limits(variable) for variable in inputs}
    used |= {symbol for pair in limits.values() for limit in pair for symbol in sympy.sympify(limit).free_symbols}
    return Model(
        name="driven",  # not by its model: models that are driven alike share the compiled equations
        states=states,
        inputs=inputs,
        outputs={str(state): state for state in states},
        parameters=tuple(spec for spec in model.parameters if used & set(spec.symbols)),
        rates=rates,
        axes=(),
        input_limits=limits,
        places=Places(inputs=model.places.inputs),
    )
