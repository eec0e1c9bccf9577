"""The lags of sensors as states of the equations, so that the filter's gains know of them."""

from dataclasses import replace

import sympy

from sim.composition.switch import sleeping
from sim.edits import with_output, with_state
from sim.effect import coefficient
from sim.model import Model, ParameterSpec, symbol


def lagged(model: Model, name: str) -> Model:
    """The model whose output passes the lag `name` ("psi_sensor.lag") while its switch `on` is 1: tau l' = y - l, and l is read."""
    output = model.places.sensors[name.split(".")[0]].output
    tau, on = ParameterSpec(coefficient(name, "tau"), 1, "s"), ParameterSpec(coefficient(name, "on"), 1, "1")
    state, switch = symbol(f"{output}_read"), on.symbols[0]
    read = sympy.sympify(model.outputs[output])
    model = replace(model, parameters=(*model.parameters, tau, on), switches=(*model.switches, switch))
    late = sleeping(model, with_state(model, state, (read - state) / tau.symbols[0]), switch)
    return with_output(late, output, lambda _: read + switch * (state - read))
