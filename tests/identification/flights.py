"""Parts of a flight, and plants whose parameters are off."""

from dataclasses import replace

from records.log import RunLog
from sim.bind import BoundPlant, bind


def cut(log: RunLog, begin_s: float, length_s: float) -> RunLog:
    """So many seconds of a log of 100 rows a second."""
    rows = slice(round(begin_s * 100), round((begin_s + length_s) * 100) + 1)
    return replace(log, t_s=log.t_s[rows], u=log.u[rows], y=log.y[rows], extra={})


def off(bound: BoundPlant, factors: dict[str, float]) -> BoundPlant:
    """The plant with single parameters multiplied."""
    parameters = dict(bound.plant.parameters)
    for name, factor in factors.items():
        parameters[name] = replace(parameters[name], value=parameters[name].value * factor)
    return bind(replace(bound.plant, parameters=parameters))
