"""Plant files that carry effects: read, checked, written back, simulated."""

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from records.errors import BadInput
from records.plant import Plant, load_plant, parse_plant, plant_text
from sim.added_effects import combined, library, redundant, with_effects, with_values, without_effects
from sim.bind import BoundPlant, bind
from sim.plants import MODELS
from sim.simulate import simulate
from tests.sim.conftest import PLANTS
from tests.soak import sampled

SPRING = """
[effects.azimuth.cable_spring.k]
value = 0.003
sd = 0.0001
unit = "N m rad^-1"
source = "found"

[effects.azimuth.cable_spring.angle_0]
value = 0.2
sd = 0.05
unit = "rad"
source = "found"
"""


def ce150_with(text: str) -> Plant:
    whole = (PLANTS / "ce150.toml").read_text(encoding="utf-8") + text
    return parse_plant(tomllib.loads(whole), "ce150", "ce150.toml")


@pytest.fixture(scope="module", params=sampled(MODELS, keep=["emps"]))
def nominal(request: pytest.FixtureRequest) -> BoundPlant:
    """Each plant in turn."""
    return bind(load_plant(PLANTS / f"{request.param}.toml"))


def sizes(bound: BoundPlant, name: str) -> dict[str, float]:
    return {parameter.symbol: parameter.reference for parameter in library(bound)[name].parameters}


def test_a_plant_file_s_effect_is_in_its_equations_and_parameters() -> None:
    bound = bind(ce150_with(SPRING))
    names = [str(symbol) for symbol in bound.model.parameter_symbols]
    assert names[-3:] == [f"azimuth_cable_spring_{symbol}" for symbol in ("k", "angle_0", "h")]
    # The straight spring of the plain formula, as the file leaves out what refines it.
    np.testing.assert_array_equal(bound.p[-3:], [0.003, 0.2, 0.0])
    np.testing.assert_array_equal(bound.sd[-3:], [0.0001, 0.05, 0.0])


def test_every_effect_of_every_plant_binds_and_is_read_back_as_written(nominal: BoundPlant) -> None:
    for name in library(nominal):
        bound = with_effects(nominal, {name: sizes(nominal, name)}, source="test")
        text = plant_text(bound.plant)
        again = bind(parse_plant(tomllib.loads(text), bound.plant.name, "again"))
        assert again.plant == bound.plant
        assert again.model is bound.model
        np.testing.assert_array_equal(again.p, bound.p)
        assert (len(again.input_path), len(again.output_path)) == (len(bound.input_path), len(bound.output_path))
        assert without_effects(bound).plant == nominal.plant


OTHERS = [name for name in MODELS if name not in ("ce150", "ce150_seed_literal")]


@pytest.mark.parametrize("name", OTHERS)
def test_all_effects_on_the_equations_of_a_plant_bind_together(name: str) -> None:
    nominal = bind(load_plant(PLANTS / f"{name}.toml"))
    inner = {name: sizes(nominal, name) for name, effect in library(nominal).items() if effect.edit is not None}
    bound = with_effects(nominal, inner)
    assert set(bound.effects) == set(inner)
    assert without_effects(bound).plant == nominal.plant


@pytest.mark.soak  # every effect runs on the CE150 in test_effects_physics.py, and binds to each of these above
@pytest.mark.parametrize("name", OTHERS)
def test_every_effect_of_the_other_plants_runs_two_seconds(name: str) -> None:
    """At its reference from rest under steps of the inputs; one model holds all that are torques or outputs.

    A lag of no time beside it makes a stage of an effect that is a function of the inputs: nothing needs to be compiled for it.
    """
    nominal = bind(load_plant(PLANTS / f"{name}.toml"))
    effects, model = library(nominal), nominal.model
    inner: dict[str, dict[str, float]] = {name: {} for name, effect in effects.items() if effect.edit is not None}
    everything = with_effects(nominal, inner)
    lag = f"{next(iter(model.places.inputs))}.lag"
    t_s = np.arange(201) * 0.01
    u = np.outer(0.2 + 0.2 * (np.arange(201) % 50 < 25), [entry.size for entry in model.places.inputs.values()])
    start = np.zeros(len(model.states))
    for effect in effects:
        given = {effect: sizes(nominal, effect)}
        bound = with_values(everything, given) if effect in inner else with_effects(nominal, {lag: {}} | given)
        y = simulate(bound, t_s, start, u).y
        assert y is not None
        assert y.shape == (201, len(model.outputs))
        assert np.all(np.isfinite(y)), effect


def test_friction_that_the_plant_states_loosely_is_redundant_and_more_of_a_well_known_one_is_a_change_of_the_rig() -> (
    None
):
    stated, bare = bind(load_plant(PLANTS / "ce150.toml")), bind(load_plant(PLANTS / "emps.toml"))
    assert redundant(stated, library(stated)["azimuth.coulomb"], 8.0)  # 0.24 mN m, stated to 0.15
    assert not redundant(stated, library(stated)["azimuth.coulomb"], 1.0)
    assert not redundant(bare, library(bare)["carriage.coulomb"], 8.0)
    assert not redundant(stated, library(stated)["azimuth.cable_spring"], 8.0)


def changed(spring: Mapping[str, Any]) -> str:
    """SPRING with other lines for k."""
    lines = {"value": "0.003", "sd": "0.0001", "unit": '"N m rad^-1"', "source": '"found"'} | dict(spring)
    body = "\n".join(f"{key} = {value}" for key, value in lines.items() if value is not None)
    return (
        SPRING[: SPRING.index("value")]
        + body
        + "\n"
        + SPRING[SPRING.index("\n[effects.azimuth.cable_spring.angle_0") :]
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            SPRING.replace("cable_spring", "cabel_spring"),
            r"effect 'azimuth.cabel_spring': .* such as azimuth.cable_spring",
        ),
        (SPRING.replace("azimuth", "yaw"), r"place 'yaw': .*no place of model 'ce150', expected one of main_input, "),
        (
            SPRING.replace("effects.azimuth", "effects.main_input"),
            r"effect 'main_input.cable_spring': .* such as azimuth.cable_spring",
        ),
        (SPRING[: SPRING.index("[effects.azimuth.cable_spring.angle_0")], r"key 'angle_0': got nothing"),
        (SPRING.replace("angle_0", "angle_1"), r"key 'angle_0': got nothing"),
        (SPRING + SPRING.replace("angle_0", "q").replace(".k]", ".r]"), r"key 'r': got an unknown key"),
        (changed({"unit": '"V"'}), r"unit: got 'V', expected 'N m rad\^-1'"),
        (changed({"unit": '"Nm"'}), r"unit: got 'Nm', expected coherent SI units"),
        (changed({"value": "3.0"}), r"value: got 3.0, expected -0.02 to 0.08 N m rad\^-1"),
        (changed({"value": "nan"}), r"number: got nan, expected a finite number"),
        (changed({"value": "[1.0, 2.0]", "sd": "[0.0, 0.0]"}), r"value: got 2 coefficients, expected one number"),
        (changed({"sd": "-1.0"}), r"sd: got -1.0"),
        (changed({"source": None}), r"key 'source': got nothing"),
        ("\n[effects]\nazimuth = 3\n", r"a table: got 3"),
        ("\n[effects.azimuth]\ncable_spring = 3\n", r"a table: got 3"),
    ],
)
def test_a_wrong_effect_in_a_plant_file_is_refused_by_name(text: str, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        bind(ce150_with(text))


def test_wrong_effects_asked_for_by_name_are_refused(bound: BoundPlant) -> None:
    with pytest.raises(BadInput, match=r"effect 'azimuth.spring': .* such as azimuth.cable_spring"):
        with_effects(bound, {"azimuth.spring": {}})
    with pytest.raises(BadInput, match=r"parameter 'c': got an unknown name, expected one of k, angle_0"):
        with_effects(bound, {"azimuth.cable_spring": {"c": 1.0}})
    with pytest.raises(BadInput, match=r"value: got 5.0, expected -0.02 to 0.08"):
        with_effects(bound, {"azimuth.cable_spring": {"k": 5.0}})
    with pytest.raises(BadInput, match=r"effect 'azimuth.tilt': got not among those added"):
        with_values(combined(bound, ["azimuth.wind"]), {"azimuth.tilt": {"m": 0.001}})
    with pytest.raises(BadInput, match=r"effect 'azimuth.spring'"):
        combined(bound, ["azimuth.spring"])


def test_a_plant_without_effects_is_bound_as_before(bound: BoundPlant) -> None:
    assert bound.effects == {}
    assert bind(replace(bound.plant, effects={})).model is bound.model is MODELS["ce150"]()
