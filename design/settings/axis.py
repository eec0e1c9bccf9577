"""The wishes for one axis: as stated, else as the plant's model has them, else plain."""

import math
from collections.abc import Mapping
from typing import Any

from design.pins import demand_in_reach
from design.pole_placement import FREE_DEGREES, INTEGRAL
from design.settings.entries import count, entry
from design.settings.poles import read_poles, read_roll_off
from design.settings.ranges import AZIMUTH_SHARE, SHARE, check_range, range_end, within
from design.settings.wishes import AxisSettings
from design.structure import stops
from records.errors import BadInput
from records.loops import Loop
from records.plant import PLANTS, Plant, load_plant
from records.table import Schedule
from records.text import checks
from records.text.units import unit_of
from sim.bind import BoundPlant
from sim.manoeuvres import LEAST_HOP

# Wishes for an axis that neither its plant file nor that of its model states anything of; the poles are named by one of them.
PLAIN_AXIS: Mapping[str, Any] = {
    "roll_off_pole_rad_s": 0.0,
    "coefficient_degree": None,
    "free_degree": INTEGRAL,
    "prefilter_time_constant_s": 0.0,
    "observer_pole": 0.9,
}

# Poles of a plant file's own are placed alone, and scheduled, unless it asks for a roll-off or another degree as well.
OWN_POLES: Mapping[str, float | None] = {"roll_off_pole_rad_s": 0.0, "coefficient_degree": None}


def read_axis(
    bound: BoundPlant, design: Mapping[str, Any], loop: Loop, design_where: str, schedule: Schedule | None
) -> AxisSettings:
    """The [design.AXIS] table of one loop; raises BadInput naming the key that cannot be used."""
    axis, where = loop.axis, f"{design_where}.{loop.axis}"
    section = checks.table(design.get(axis, {}), where)
    wished = tuple(loop.own(name) for name in AxisSettings.__dataclass_fields__ if name != "axis")
    of_model = _wishes_of_model(bound.plant, axis)
    checks.keys(section, where, () if "poles_rad_s" in of_model else ("poles_rad_s",), (*wished, "output", "input"))
    defaults = {**PLAIN_AXIS, **of_model, **(OWN_POLES if "poles_rad_s" in section else {})}
    filter_s = _time_constant(
        entry(section, "prefilter_time_constant_s", defaults), f"{where}.prefilter_time_constant_s"
    )
    low, high = _reference_rad(bound, section, loop, where, schedule)
    return AxisSettings(
        axis=axis,
        poles_rad_s=read_poles(entry(section, "poles_rad_s", defaults), f"{where}.poles_rad_s"),
        roll_off_pole_rad_s=read_roll_off(
            entry(section, "roll_off_pole_rad_s", defaults), f"{where}.roll_off_pole_rad_s"
        ),
        coefficient_degree=_own_degree(entry(section, "coefficient_degree", defaults), where),
        free_degree=_free_degree(entry(section, "free_degree", defaults), f"{where}.free_degree"),
        prefilter_time_constant_s=filter_s,
        observer_pole=_observer_pole(entry(section, "observer_pole", defaults), f"{where}.observer_pole"),
        reference_min_rad=low,
        reference_max_rad=high,
        **{
            name: checks.number(section[loop.own(name)], f"{where}.{loop.own(name)}")
            for name in ("u_min_V", "u_max_V")
            if loop.own(name) in section
        },
    )


def _wishes_of_model(plant: Plant, axis: str) -> Mapping[str, Any]:
    """What the project's own file of the plant's model wishes for an axis of this name; its ranges follow from the plant's stops."""
    file = PLANTS / f"{plant.model}.toml"
    if plant.equations is not None or not file.is_file():
        return {}
    section = load_plant(file).design.get(axis, {})
    return {name: value for name, value in section.items() if name in PLAIN_AXIS or name == "poles_rad_s"}


def _reference_rad(
    bound: BoundPlant, section: Mapping[str, Any], loop: Loop, where: str, schedule: Schedule | None
) -> tuple[float, float]:
    """How far references reach: by default as far as the schedule, where it goes by this loop, else most of the way to the stops."""
    stops_rad = stops(bound, loop)
    if schedule is not None and schedule.axis == loop.axis:
        default: tuple[float, float] | None = (schedule.min_rad, schedule.max_rad)
    else:
        default = within(stops_rad, AZIMUTH_SHARE if loop.axis == "azimuth" else SHARE)
    ends = (loop.own("reference_min_rad"), loop.own("reference_max_rad"))
    low, high = (range_end(section, key, default, end, where) for end, key in enumerate(ends))
    check_range(f"{where}: {', '.join(ends)}", low, high, stops_rad, "reference range", loop)
    demand_in_reach(loop, low, high, "reference range", f"{where}: {', '.join(ends)}")
    _demand_shown(bound, loop, low, high, f"{where}: {', '.join(ends)}")
    return low, high


def _demand_shown(bound: BoundPlant, loop: Loop, low_rad: float, high_rad: float, where: str) -> None:
    """Raise BadInput where a sensor shows nothing of a flight: its references end on whole steps, and all of them on the same."""
    step_rad = bound.plant.sensors[loop.output]
    least = math.ceil(1.0 / LEAST_HOP)
    if high_rad - low_rad < least * step_rad:
        got = f"{low_rad:g} .. {high_rad:g} {unit_of(loop.output)}, {(high_rad - low_rad) / step_rad:.2g} steps of its sensor"
        remedy = f"widen the range, or correct {loop.own('resolution_rad')}"
        raise BadInput("reference range", where, got, f"{least} steps at least", remedy)


def _time_constant(value: Any, where: str) -> float:
    filter_s = checks.number(value, where)
    if filter_s < 0.0:
        raise BadInput("time constant", where, repr(filter_s), "0 or more", "write 0 for no filter")
    return filter_s


def _own_degree(value: Any, where: str) -> int | None:
    return None if value is None else count({"coefficient_degree": value}, "coefficient_degree", where, {})


def _free_degree(value: Any, where: str) -> str:
    name = checks.text(value, where)
    if name not in FREE_DEGREES:
        known = ", ".join(repr(known) for known in FREE_DEGREES)
        raise BadInput("free degree", where, repr(name), f"one of {known}", "name the condition that fixes eq (26)")
    return name


def _observer_pole(value: Any, where: str) -> float:
    pole = checks.number(value, where)
    if not 0.0 <= pole < 1.0:
        raise BadInput("observer pole", where, repr(pole), "0 <= pole < 1, in z", "choose a stable pole such as 0.9")
    return pole
