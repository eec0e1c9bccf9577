"""Gusts as states of the equations: what drives them next is unknown, and the filter estimates what it does now."""

from dataclasses import replace

from sim.composition.switch import sleeping
from sim.edits import with_state, with_torque
from sim.effect import coefficient
from sim.model import Model, ParameterSpec, symbol


def gust_state(name: str) -> str:
    """The state that carries the gust `name` ("elevation.gust")."""
    return name.replace(".", "_")


def gusty(model: Model, name: str) -> Model:
    """The model whose axis feels the gust `name` while its switch `on` is 1: g' = - g / T, and g is a torque.

    The noise that drives it, sigma sqrt(2 / T) on g', is the filter's: sigma^2 is then the variance of g.
    """
    axis = name.split(".")[0]
    sigma = ParameterSpec(coefficient(name, "sigma"), 1, model.places.axes[axis].torque_unit)
    T, on = ParameterSpec(coefficient(name, "T"), 1, "s"), ParameterSpec(coefficient(name, "on"), 1, "1")
    state, switch = symbol(gust_state(name)), on.symbols[0]
    model = replace(model, parameters=(*model.parameters, sigma, T, on), switches=(*model.switches, switch))
    return sleeping(model, with_torque(with_state(model, state, -state / T.symbols[0]), axis, switch * state), switch)
