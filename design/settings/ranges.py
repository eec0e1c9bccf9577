"""Ranges of angles within an axis' stops: which angle is scheduled and over how much of it, how far references reach."""

import math
from collections.abc import Mapping
from typing import Any

import sympy

from design.structure import stops
from records.errors import BadInput
from records.loops import LOOPS, Loop
from records.table import Schedule, range_keys
from records.text import checks
from records.text.units import unit_of
from sim.bind import BoundPlant

# Share of the hard stops that the defaults use, so that neither schedule nor reference ends on a stop; the azimuth's by its own name.
SHARE, AZIMUTH_SHARE = 8.0 / 9.0, 12.0 / 13.0


def scheduling_loop(section: Mapping[str, Any], loops: tuple[Loop, ...], where: str) -> Loop | None:
    """The loop whose angle the coefficients go by; the helicopter's is its first."""
    if "schedule" not in section:
        return loops[0] if loops == LOOPS else None
    name = checks.text(section["schedule"], f"{where}.schedule")
    for loop in loops:
        if name == loop.output:
            return loop
    known = ", ".join(loop.output for loop in loops)
    raise BadInput(
        "schedule", f"{where}.schedule", repr(name), f"a loop's output, {known}", "leave it out for no schedule"
    )


def read_schedule(bound: BoundPlant, section: Mapping[str, Any], loop: Loop, where: str) -> Schedule:
    """The angle of `loop` as what the coefficients go by, over the range stated or most of that between its stops."""
    _demand_rests(bound, loop, f"{where}.schedule")
    low_key, high_key = range_keys(loop)
    stops_rad = stops(bound, loop)
    default = within(stops_rad, SHARE)
    low, high = (range_end(section, key, default, end, where) for end, key in enumerate((low_key, high_key)))
    check_range(f"{where}: {low_key}, {high_key}", low, high, stops_rad, "operating range", loop)
    return Schedule(loop.axis, low, high)


def _demand_rests(bound: BoundPlant, loop: Loop, where: str) -> None:
    """Raise BadInput where the output moves a position: at no value of it but one does the plant rest."""
    model = bound.nominal
    moving = [axis for axis in model.axes if axis.position is not None]
    measured = sympy.sympify(model.outputs[loop.output]).free_symbols
    axis = next((axis for axis in moving if axis.velocity in measured), None)
    if axis is not None:
        got = f"{loop.output}, by which {axis.position} moves"
        expected = "an output that stays while the plant rests, such as the position of an axis"
        raise BadInput("schedule", where, got, expected, "leave it out for no schedule")


def range_end(section: Mapping[str, Any], key: str, default: tuple[float, float] | None, end: int, where: str) -> float:
    """The lower (0) or upper (1) end of a range, as the section states it or by default."""
    if key not in section and default is None:
        raise BadInput(f"key {key!r}", where, "nothing", "a number, as this axis has no stops", f"add {key}")
    return checks.number(section.get(key, default[end] if default else None), f"{where}.{key}")


def within(stops_rad: tuple[float, float], share: float) -> tuple[float, float] | None:
    """The default of a range within stops; None where there are none."""
    return (share * stops_rad[0], share * stops_rad[1]) if all(map(math.isfinite, stops_rad)) else None


def check_range(where: str, low: float, high: float, stops_rad: tuple[float, float], what: str, loop: Loop) -> None:
    """Raise BadInput unless the range is one, and within the stops."""
    unit = unit_of(loop.output)
    got = f"{low:g} .. {high:g} {unit}".rstrip()
    if low >= high:
        raise BadInput(what, where, f"{got}, which is empty", "min < max", "widen the range")
    if low < stops_rad[0] or high > stops_rad[1]:
        symmetric = stops_rad[0] == -stops_rad[1]
        stops = f"+-{stops_rad[1]:g} {unit}" if symmetric else f"{stops_rad[0]:g} and {stops_rad[1]:g} {unit}"
        raise BadInput(what, where, got, f"a range within the hard stops at {stops}", "narrow the range")
