"""What a plant fixes about its logs."""

from collections.abc import Mapping
from dataclasses import dataclass

from sim.bind import BoundPlant


@dataclass(frozen=True)
class PlantFacts:
    """What a plant fixes about its logs: encoder steps by output, limits by input, stops by output, outputs that are an axis' position."""

    steps: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    stops: Mapping[str, tuple[float, float]]
    positions: frozenset[str]


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
    return PlantFacts(dict(bound.plant.sensors), limits, stops, positions)
