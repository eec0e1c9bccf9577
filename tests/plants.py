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
