"""Images on the emulated board that several tests share, built once."""

import pytest

from codegen.law import generate_law
from tests.firmware.box import stand_in_law
from tests.law_tables import ce150_table
from tests.rig.images import emulated_url


@pytest.fixture(scope="session")
def ce150_url(tmp_path_factory: pytest.TempPathFactory) -> str:
    """That of the CE150's law in float32."""
    return emulated_url(generate_law(ce150_table()), tmp_path_factory.mktemp("ce150"))


@pytest.fixture(scope="session")
def stand_in_url(tmp_path_factory: pytest.TempPathFactory) -> str:
    """That of the stand-in law."""
    return emulated_url(stand_in_law(), tmp_path_factory.mktemp("stand_in"))
