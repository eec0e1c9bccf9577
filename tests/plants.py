"""Plants for tests: the project's files, with single parameters changed."""

from dataclasses import replace

from records.plant import load_plant
from sim.bind import BoundPlant, bind
from tests.test_project import ROOT

PLANTS = ROOT / "plants"


def bound(name: str, **changed: float) -> BoundPlant:
    """plants/NAME.toml bound to its equations, with the parameters `changed`."""
    plant = load_plant(PLANTS / f"{name}.toml")
    parameters = {key: replace(entry, value=changed.get(key, entry.value)) for key, entry in plant.parameters.items()}
    return bind(replace(plant, parameters=parameters))
