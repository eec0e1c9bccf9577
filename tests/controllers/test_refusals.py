"""Every controller says which plants are not its own, and why."""

from pathlib import Path

import pytest

from controllers.equations.equation_controller import EquationController
from controllers.table import CONTROLLERS
from design.settings import read_settings
from records.errors import BadInput
from records.plant import load_plant
from sim.bind import bind

OTHERS = [name for name, row in CONTROLLERS.items() if isinstance(row, EquationController) and row.needs is not None]


def test_the_papers_own_rules_alone_are_the_helicopter_s() -> None:
    assert OTHERS == ["instantaneous", "fuzzy"]


@pytest.mark.parametrize("name", OTHERS)
def test_a_plant_that_is_no_helicopter_is_told_why_it_cannot_have_it(name: str) -> None:
    row, bound = CONTROLLERS[name], bind(load_plant(Path("plants/aeroshield.toml")))
    assert isinstance(row, EquationController)
    told = f"plant for the controller '{name}': .*as model ce150 has them: {row.needs}; .*the scheduled law"
    for asked in (row.design, row.points):
        with pytest.raises(BadInput, match=told):
            asked(bound, read_settings(bound))
