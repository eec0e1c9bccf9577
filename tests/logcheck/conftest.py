"""An arm with a plant file of its own, for logs of one input and one output."""

import pytest

from sim.bind import BoundPlant
from tests.own_plants import WORKING
from twinlaw import load


@pytest.fixture(scope="session")
def arm(tmp_path_factory: pytest.TempPathFactory) -> BoundPlant:
    return load(str(WORKING["plain"].write(tmp_path_factory.mktemp("arm"), "my_arm")))
