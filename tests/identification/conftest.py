"""The CE150, one rig drawn from what its file states, and the nine experiments on that rig."""

from pathlib import Path

import pytest

from identification.experiments.table import KINDS, perform
from identification.proof.monte_carlo import other_rig
from identification.stages.staged import identify_staged
from records.plant import load_plant
from sim.bind import bind

PLANTS = Path(__file__).parents[2] / "plants"
SEED = 3


@pytest.fixture(scope="session")
def bound():
    return bind(load_plant(PLANTS / "ce150.toml"))


@pytest.fixture(scope="session")
def truth(bound):
    return other_rig(bound, SEED)


@pytest.fixture(scope="session")
def experiments(truth):
    return {kind: perform(kind, truth, SEED) for kind in KINDS}


@pytest.fixture(scope="session")
def stages(bound, experiments):
    return identify_staged(bound, list(experiments.values()))
