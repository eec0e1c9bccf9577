"""A sensor's lag as a state of the equations, so that the filter's gains know of it."""

from dataclasses import replace

import sympy

from sim.effects.edits import with_output, with_state
from sim.effects.effect import coefficient
from sim.model import Model, ParameterSpec, symbol


def lagged(model: Model, name: str) -> Model:
    """The model whose output passes the lag `name` ("psi_sensor.lag"): tau l' = y - l, and l is read."""
    output = model.places.sensors[name.split(".")[0]].output
    tau = ParameterSpec(coefficient(name, "tau"), 1, "s")
    state = symbol(f"{output}_read")
    rate = (sympy.sympify(model.outputs[output]) - state) / tau.symbols[0]
    model = replace(model, parameters=(*model.parameters, tau))
    return with_output(with_state(model, state, rate), output, lambda _: state)
