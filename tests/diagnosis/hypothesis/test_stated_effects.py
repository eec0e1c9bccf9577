"""A plant file that already states an effect: that is no gap, what comes beside it is, and so is another size of it."""

from collections.abc import Mapping

import pytest

from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.diagnose import Material, diagnose
from diagnosis.explain.improved import improved_plant
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.result import Result
from diagnosis.search.retune import retune
from sim.added_effects import with_effects
from sim.bind import BoundPlant, bind
from tests.diagnosis.conftest import LONG_S, RIG, SPRING, SPRUNG_SECONDS, Fly
from tests.diagnosis.nominal import nominal_fit

DRAG = "elevation.quadratic_drag"


def diagnosed_again(sprung: Result, fly: Fly, effects: Mapping[str, Mapping[str, float]]) -> Result:
    logs = [fly(seed, effects, SPRUNG_SECONDS, rig_seed=RIG) for seed in (13, 14)]
    return diagnose(bind(sprung.plant), Material(logs[:1], logs[1:], ["hold"], [None, None]))


@pytest.mark.soak
def test_the_improved_plant_fed_back_in_shows_no_gap(sprung: Result, fly: Fly) -> None:
    assert set(sprung.diagnosis.found) == {"azimuth.cable_spring"}
    again = diagnosed_again(sprung, fly, SPRING)
    assert again.diagnosis.verdict == "no gap"
    assert again.diagnosis.found == ()
    assert set(bind(again.plant).effects) == {"azimuth.cable_spring"}
    # As stated it now predicts like the improved plant did.
    shrunk, before = again.diagnosis.shrinkage, sprung.diagnosis.shrinkage
    assert shrunk is not None
    assert before is not None
    assert shrunk.rms_nominal["phi_rad"] < 0.2 * before.rms_nominal["phi_rad"]


@pytest.mark.soak
def test_a_second_effect_is_seen_beside_the_stated_one(plant: BoundPlant, fly: Fly) -> None:
    # Truth: of all effects a drag is missing; with the spring as stated there is nothing else to see.
    stated = with_effects(plant, SPRING, sd={"azimuth.cable_spring": {"k": 1e-4, "angle_0": 0.01, "h": 1e-3}})
    log = fly(13, {**SPRING, DRAG: {"c": 2e-3}}, rig_seed=RIG)
    case = make_case(effect_library(plant), [log], stated=stated)
    nominal = nominal_fit(case)
    first, *others = score_effects(case, linearised(case, nominal), case.library.names)
    assert first.effect == DRAG
    assert "azimuth.cable_spring" not in [entry.effect for entry in others]
    found = fit(case, nominal.hypothesis.with_effects({**nominal.hypothesis.effects, DRAG: first.values}))
    assert found is not None
    assert found.hypothesis.effects[DRAG]["c"] == pytest.approx(2e-3, rel=0.15)
    assert case.added(found.hypothesis.effects) == (DRAG,)
    assert set(bind(improved_plant(case, as_fitted(case, found))).effects) == {"azimuth.cable_spring", DRAG}


@pytest.mark.soak
def test_a_second_effect_is_found_beside_the_stated_one(sprung: Result, fly: Fly) -> None:
    again = diagnosed_again(sprung, fly, {**SPRING, "elevation.quadratic_drag": {"c": 2e-3}})
    assert again.diagnosis.verdict == "gap"
    assert again.diagnosis.found == ("elevation.quadratic_drag",)
    top = again.diagnosis.effects[0]
    assert top.effect == "elevation.quadratic_drag"
    assert top.parameters["c"].value == pytest.approx(2e-3, rel=0.15)
    assert set(bind(again.plant).effects) == {"azimuth.cable_spring", "elevation.quadratic_drag"}


@pytest.mark.soak
def test_another_size_of_the_stated_effect_is_a_re_tune(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the file states a drag of 2e-3 with 5 %, the rig has twice that: 20 standard deviations, and nothing else is missing.
    stated = with_effects(plant, {DRAG: {"c": 2e-3}}, sd={DRAG: {"c": 1e-4}})
    case = make_case(effect_library(plant), [fly(13, {DRAG: {"c": 4e-3}}, LONG_S, rig_seed=RIG)], stated=stated)
    found = retune(case, nominal_fit(case))
    assert found is not None
    assert (found.parameters, found.places) == ((f"{DRAG}.c",), {"elevation": 1.0})
    assert bind(improved_plant(case, found.fitted)).effects[DRAG]["c"].values[0] == pytest.approx(4e-3, rel=0.1)


@pytest.mark.soak
def test_another_size_of_the_stated_effect_is_told_as_that(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the file states a drag of 2e-3 with 5 %, the rig has twice that: 20 standard deviations, and nothing else is missing.
    stated = with_effects(
        plant, {"elevation.quadratic_drag": {"c": 2e-3}}, sd={"elevation.quadratic_drag": {"c": 1e-4}}
    )
    logs = [fly(seed, {"elevation.quadratic_drag": {"c": 4e-3}}, rig_seed=RIG) for seed in (13, 14)]
    result = diagnose(stated, Material(logs[:1], logs[1:], ["hold"], [None, None]))
    assert result.diagnosis.verdict == "gap"
    assert result.diagnosis.found == ()
    assert any(note.startswith("c of elevation.quadratic_drag is +") for note in result.diagnosis.notes)
    assert result.diagnosis.places[0].place == "elevation"
    c = bind(result.plant).effects["elevation.quadratic_drag"]["c"].values[0]
    assert c == pytest.approx(4e-3, rel=0.1)
