"""The whole diagnosis on flights whose truth is known: nothing there, one effect, two at once."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import Material, diagnose
from diagnosis.result import Result
from records.diagnosis import diagnosis_text
from records.plant import plant_text
from sim.bind import BoundPlant, bind
from tests.diagnosis.arm import SECONDS, arm, arm_log
from tests.diagnosis.conftest import RIG, RUB, SPRING, SPRUNG_SECONDS, Fly


def test_a_run_of_the_stated_plant_shows_no_gap() -> None:
    logs = [arm_log(seed=seed) for seed in (11, 12)]
    diagnosis = diagnose(arm(), Material(logs[:1], logs[1:], ["hold"], [None, None])).diagnosis
    assert diagnosis.verdict == "no gap"
    assert diagnosis.found == ()
    assert (diagnosis.false_alarm_probability or 0.0) > 0.01
    assert diagnosis.verdict_reason == "nothing_seen"
    rules = [entry.rule for entry in diagnosis.decisions]
    first = rules.index("largest_gain")
    assert rules[first : first + 4] == ["largest_gain", "parameters_together", "parameter_furthest", "false_alarm"]
    told = diagnosis.decisions[first + 3]
    assert (told.value, told.limit, told.outcome) == (diagnosis.false_alarm_probability, 0.001, "no gap")


def test_a_rub_is_found_with_its_level(rubbed: Result) -> None:
    diagnosis = rubbed.diagnosis
    assert diagnosis.verdict == "gap"
    top = diagnosis.effects[0]
    assert (top.effect, diagnosis.found) == ("arm.coulomb", ("arm.coulomb",))
    assert top.parameters["b"].value == pytest.approx(RUB["arm.coulomb"]["b"], rel=0.05)
    assert diagnosis.places[0].place == "arm"


@pytest.mark.soak  # a cold library of the largest plant
def test_a_spring_is_found_with_its_stiffness(sprung: Result) -> None:
    diagnosis = sprung.diagnosis
    assert diagnosis.verdict == "gap"
    family = {"azimuth.cable_spring", "azimuth.tilt", "azimuth.wind"}
    top = diagnosis.effects[0]
    named = {top.effect, *top.ambiguous_with}
    assert "azimuth.cable_spring" in named
    assert top.effect in family
    stiffness = next(h for h in diagnosis.effects if h.effect == "azimuth.cable_spring").parameters["k"].value
    assert stiffness == pytest.approx(0.004, rel=0.1)
    assert diagnosis.places[0].place == "azimuth"


def test_the_answer_is_a_valid_record_and_its_plant_binds(rubbed: Result) -> None:
    assert '"schema": "diagnosis/1"' in diagnosis_text(rubbed.diagnosis)
    assert sum(row.share for row in rubbed.diagnosis.places) == pytest.approx(1.0)
    bound = bind(rubbed.plant)
    assert plant_text(rubbed.plant)
    assert set(rubbed.diagnosis.found) == set(bound.effects)


@pytest.mark.soak  # in every suite tests/twinlaw/test_diagnosing_each.py compares files of another process
def test_the_same_logs_give_the_same_answer(plant: BoundPlant, fly: Fly, sprung: Result) -> None:
    logs = [fly(seed, SPRING, SPRUNG_SECONDS, rig_seed=RIG) for seed in (11, 12)]
    again = diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None]))
    assert diagnosis_text(again.diagnosis) == diagnosis_text(sprung.diagnosis)


def test_predictions_cover_the_hold_out(rubbed: Result) -> None:
    (predicted,) = rubbed.predicted
    for variant in ("nominal", "before", "after"):
        assert np.isfinite(predicted.by[variant]).mean() > 1.0 - 2.1 / SECONDS  # but for the first two seconds


@pytest.mark.soak  # in every suite test_parameter_alone.py has another parameter
def test_a_parameter_beyond_its_spread_is_named_and_no_effect(plant: BoundPlant, fly: Fly) -> None:
    # Truth: one rig whose J_A is 60 % up, 12 of its standard deviations. Without it the plant predicts the hold-out worse by far.
    logs = [fly(seed, factors={"J_A": 1.6}, rig_seed=21) for seed in (21, 22)]
    diagnosis = diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None])).diagnosis
    assert diagnosis.verdict == "gap"
    assert (diagnosis.found, diagnosis.verdict_reason) == ((), "parameters_alone")
    assert diagnosis.unknown.probability < 0.5
    assert any("parameter J_A" in note for note in diagnosis.notes)
    assert diagnosis.places[0].place == "azimuth"


@pytest.mark.soak  # in every suite tests/twinlaw/verbs/test_diagnose.py has a log of one constant
def test_a_rig_at_rest_gives_no_name(plant: BoundPlant, fly: Fly) -> None:
    log = fly(31, seconds=6.0)
    still = replace(log, t_s=log.t_s[:300], u=np.tile(log.u[:1], (300, 1)), y=np.zeros((300, 2)))
    diagnosis = diagnose(plant, Material([still], [], [], [None])).diagnosis
    assert diagnosis.verdict != "gap" or diagnosis.found == ()
