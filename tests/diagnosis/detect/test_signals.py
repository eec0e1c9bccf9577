"""Which state an input drives: a rotor's speed, an axis' velocity where it pushes at once, what is heated or filled."""

from pathlib import Path

import pytest
import sympy

from diagnosis.detect.signals import driven
from records.plant import load_plant
from sim.bind import BoundPlant, bind
from tests.own_plants import HEATER, TWO_HEATERS
from tests.plants import bound

ITS_NUMBERS = {
    "ce150": ("u_M_V", "omega_M_rad_s"),
    "emps": ("u_V", "q_dot_m_s"),
    "aeroshield": ("u_V", "theta_dot_rad_s"),
}


def slope(plant: BoundPlant, name: str) -> tuple[str, float]:
    """The state that an input drives, and the slope of its rate."""
    variable = next(entry for entry in plant.model.inputs if str(entry) == name)
    found = driven(plant.model, variable)
    assert found is not None
    return found[0], plant.number(found[1])


@pytest.mark.parametrize("name", list(ITS_NUMBERS))
def test_rigs_are_driven_at_a_rotor_or_at_the_axis_itself(name: str) -> None:
    plant, (variable, state) = bound(name), ITS_NUMBERS[name]
    # Truth by their equations: K_M of the rotor's rate; gtau / M; l K / (m l^2).
    p = plant.parameter
    wanted = {
        "ce150": lambda: p("K_M"),
        "emps": lambda: p("gtau") / p("M"),
        "aeroshield": lambda: p("K") / (p("m") * p("l")),
    }
    assert slope(plant, variable) == (state, pytest.approx(wanted[name]()))


def test_each_heater_heats_its_own_body_and_nothing_else_drives(tmp_path: Path) -> None:
    one = bind(load_plant(HEATER.write(tmp_path / "one", "body")))
    two = bind(load_plant(TWO_HEATERS.write(tmp_path / "two", "bodies")))
    assert slope(one, "heat_W") == ("T_K", pytest.approx(1.0 / 20.0))
    assert slope(two, "heat1_W") == ("T1_K", pytest.approx(1.0 / 30.0))
    assert slope(two, "heat2_W") == ("T2_K", pytest.approx(1.0 / 30.0))
    assert driven(one.model, sympy.Symbol("another_V", real=True)) is None
