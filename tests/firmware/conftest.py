"""The image around a stand-in law, built once."""

import pytest

from rig.programming.image import build_firmware
from tests.firmware.box import stand_in_law


@pytest.fixture(scope="session")
def stand_in() -> bytes:
    return build_firmware(stand_in_law()).elf
