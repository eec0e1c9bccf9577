"""How slow a plant is, and times in its effects: those of a rig of the table are in seconds, a heated body's in half minutes."""

from dataclasses import replace
from pathlib import Path

import pytest

from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.effect import EffectParameter, Role
from sim.effects import effects_for
from sim.plants import MODELS
from tests.own_plants import HEATER, NO_AXIS, OwnPlant
from tests.plants import bound


def written(plant: OwnPlant, folder: Path) -> BoundPlant:
    return bind(load_plant(plant.write(folder, "own")))


# C / G = 25 s and L / R = 0.05 s; the time constant of the heater's sibling is 20 / 16 = 1.25 s.
@pytest.mark.parametrize(
    ("plant", "second_s"),
    [
        (HEATER, 32.0),
        (NO_AXIS, 1.0),
        (replace(HEATER, parameters={**HEATER.parameters, "G": (16.0, 1.6, "W K^-1")}), 1.0),
    ],
)
def test_a_plant_where_nothing_moves_has_seconds_as_long_as_its_fastest_state_takes(
    plant: OwnPlant, second_s: float, tmp_path: Path
) -> None:
    assert written(plant, tmp_path).model.second_s == second_s


@pytest.mark.parametrize("name", ["ce150", "emps", "maglev_coil", "quanser_aero"])
def test_rigs_of_the_table_are_as_they_were(name: str) -> None:
    assert bound(name).nominal is MODELS[bound(name).plant.model]()
    assert bound(name).model.second_s == 1.0


def test_other_values_of_its_parameters_leave_it_and_the_model_as_they_are(tmp_path: Path) -> None:
    stated = written(HEATER, tmp_path / "stated")
    retuned = written(replace(HEATER, parameters={**HEATER.parameters, "C": (23.0, 2.0, "J K^-1")}), tmp_path / "tuned")
    assert stated.nominal is stated.nominal
    assert retuned.nominal.second_s == stated.nominal.second_s


def test_times_of_its_effects_are_its_own_and_instants_those_of_the_logs(tmp_path: Path) -> None:
    slow = effects_for(written(HEATER, tmp_path / "slow").nominal)
    fast = effects_for(
        written(
            replace(HEATER, parameters={**HEATER.parameters, "G": (16.0, 1.6, "W K^-1")}), tmp_path / "fast"
        ).nominal
    )

    def bounds(entry: EffectParameter) -> list[float]:
        return [entry.lower, entry.upper, entry.reference, *entry.starts]

    for effect, symbol, factor in (
        ("heater.delay", "tau", 32.0),
        ("probe.lag", "tau", 32.0),
        ("heater.slew_limit", "r", 1.0 / 32.0),
        ("heater.deadzone", "d", 1.0),
    ):
        one, other = (effects[effect].parameter[symbol] for effects in (slow, fast))
        assert bounds(one) == pytest.approx([factor * value for value in bounds(other)])
    for role in (Role.INSTANT, Role.BEGINNING):
        instant = EffectParameter("t_0", "s", 0.0, 1.0e5, 10.0, role=role)
        assert instant.at_pace(32.0) is instant
