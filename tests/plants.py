"""Plants for tests: the project's files, with single parameters changed."""

from dataclasses import replace
from functools import cache

from design.operating_points import design_points
from design.settings import read_settings
from design.table import make_table
from records.plant import load_plant
from records.table import ControllerTable
from sim.bind import BoundPlant, bind
from tests.test_project import ROOT

PLANTS = ROOT / "plants"
# By axis: poles in rad/s, distinct and fast, and the time constant of the reference's filter in s.
LIVELY = {
    "elevation": ((-4.0, -5.0, -8.0, -14.0, -18.0, -24.0), 0.4),
    "azimuth": ((-4.0, -5.0, -6.0, -8.0, -10.0, -12.0), 0.5),
}


def bound(name: str, **changed: float) -> BoundPlant:
    """plants/NAME.toml bound to its equations, with the parameters `changed`."""
    plant = load_plant(PLANTS / f"{name}.toml")
    parameters = {key: replace(entry, value=changed.get(key, entry.value)) for key, entry in plant.parameters.items()}
    return bind(replace(plant, parameters=parameters))


@cache
def stated_table(name: str) -> ControllerTable:
    """The table that plants/NAME.toml asks for, as `design` makes it; its report, which takes fifteen times as long, is left out."""
    plant = bound(name)
    settings = read_settings(plant)
    return make_table(plant, settings, design_points(plant, settings))


@cache
def lively_table() -> ControllerTable:
    """A faster law of the CE150 without a roll-off: every encoder step shakes its inputs, so that a flight tells more of the plant."""
    plant = bound("ce150")
    settings = read_settings(plant)
    lively = replace(settings, coefficient_degree=3, recursion_degree=3)
    for axis, (poles, prefilter_s) in LIVELY.items():
        lively = lively.with_axis(
            axis,
            poles_rad_s=tuple(complex(pole) for pole in poles),
            roll_off_pole_rad_s=0.0,
            coefficient_degree=None,
            prefilter_time_constant_s=prefilter_s,
        )
    return make_table(plant, lively, design_points(plant, lively))
