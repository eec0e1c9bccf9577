"""The CE150, its controller and a flight; one rig drawn from what its file states and the nine experiments on it; one of the paper's."""

from pathlib import Path

import pytest

from identification.experiments.table import KINDS, perform
from identification.proof.monte_carlo import other_rig
from identification.stages.staged import identify_staged
from records.plant import load_plant
from records.table import load_table
from sim.bind import bind
from sim.loop import fly_law
from sim.manoeuvres import flight
from tests.plants import bound as plant_of

PLANTS = Path(__file__).parents[2] / "plants"
SEED = 3


@pytest.fixture(scope="session")
def bound():
    return bind(load_plant(PLANTS / "ce150.toml"))


@pytest.fixture(scope="session")
def table():
    """The controller that `twinlaw design` once made for it; a table more than these tests of estimators need not be."""
    return load_table(Path(__file__).parent / "ce150_controller.json")


@pytest.fixture(scope="session")
def flown(bound, table):
    """The project's flight over both halves of the elevation: a closed loop about an unstable plant."""
    return fly_law(bound, table, flight(bound), substeps=4)


@pytest.fixture(scope="session")
def truth(bound):
    return other_rig(bound, SEED)


@pytest.fixture(scope="session")
def experiments(truth):
    return {kind: perform(kind, truth, SEED) for kind in KINDS}


@pytest.fixture(scope="session")
def stages(bound, experiments):
    return identify_staged(bound, list(experiments.values()))


@pytest.fixture(scope="session")
def main_motor():
    """Experiment u1 of the paper's own set."""
    return perform("main_motor", plant_of("ce150_velagic"), 1)
