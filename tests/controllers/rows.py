"""Every row of the table of controllers with its table on the CE150, designed once a process."""

from functools import cache
from typing import Any

import pytest

from controllers.controller import Controller
from controllers.table import CONTROLLERS
from design.settings import read_settings
from sim.bind import BoundPlant
from tests.angles import few_angles
from tests.plants import bound

ROWS = tuple(CONTROLLERS)


@cache
def ce150() -> BoundPlant:
    """The design plant."""
    return bound("ce150")


@cache
def designed(name: str) -> tuple[Controller, Any]:
    """The row and its table."""
    row = CONTROLLERS[name]
    with pytest.MonkeyPatch.context() as patch:
        few_angles(patch)
        return row, row.design(ce150(), read_settings(ce150()))
