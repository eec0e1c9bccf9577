"""What a plant fixes about its logs."""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy

from sim.bind import BoundPlant
from sim.model import Model


@dataclass(frozen=True)
class PlantFacts:
    """What a plant fixes about its logs: encoder steps by output, limits by input, stops by output, outputs that are an axis' position,
    and by output the inputs that move it."""

    steps: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    stops: Mapping[str, tuple[float, float]]
    positions: frozenset[str]
    moved_by: Mapping[str, frozenset[str]]


def plant_facts(bound: BoundPlant) -> PlantFacts:
    """Steps, limits and stops of a bound plant; those that it has not are left out."""
    model = bound.model
    stops = {
        str(axis.position): (bound.number(axis.lower), bound.number(axis.upper))
        for axis in model.axes
        if axis.position is not None and axis.lower is not None and axis.upper is not None
    }
    limits = {str(variable): bound.limits(variable) for variable in model.inputs}
    axes = {str(axis.position) for axis in model.axes}
    positions = frozenset(output for output, expression in model.outputs.items() if str(expression) in axes)
    return PlantFacts(dict(bound.plant.sensors), limits, stops, positions, _moved_by(model))


def _moved_by(model: Model) -> Mapping[str, frozenset[str]]:
    """By output the inputs from which the equations lead to it, through the rates of as many states as it takes."""
    rates = dict(zip(model.states, model.state_rates(), strict=True))
    reached = {}
    for output, expression in model.outputs.items():
        found: set[sympy.Basic] = set()
        todo = [sympy.sympify(expression)]
        while todo:
            new = todo.pop().free_symbols - found
            found |= new
            todo += [sympy.sympify(rates[symbol]) for symbol in new if symbol in rates]
        reached[output] = frozenset(str(variable) for variable in model.inputs if variable in found)
    return reached
