"""What logs that were not fitted refute: a re-tune, which is then not written, and an effect that leaves most of their error."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.decide.holdout import Holdout, _floor, partly, worse
from diagnosis.decide.weighing import Weighed
from diagnosis.detect.instants import happens
from diagnosis.diagnose import Material, diagnose
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.nominal import nominal_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.result import Result
from records.diagnosis import Diagnosis
from sim.added_effects import library
from sim.bind import BoundPlant
from tests.diagnosis.conftest import Fly

TWO_SD = 1.1  # times J_A, which its file states to 5 %


def checked_on(plant: BoundPlant, fly: Fly, inertia: float) -> Result:
    """The answer where the rig that was fitted has TWO_SD of J_A and that of the hold-out `inertia`, all else as stated."""
    exactly = {str(symbol): 1.0 for symbol in plant.model.parameter_symbols}
    logs = [fly(seed, factors={**exactly, "J_A": factor}) for seed, factor in ((51, TWO_SD), (52, inertia))]
    return diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None]))


def test_a_re_tune_that_predicts_worse_is_not_written(plant: BoundPlant, fly: Fly) -> None:
    result = checked_on(plant, fly, 1.0)
    stated = plant.plant.parameters
    assert result.diagnosis.found == ()
    assert result.plant.parameters["J_A"].value == stated["J_A"].value
    assert result.plant.parameters["J_A"].sd == pytest.approx(stated["J_A"].sd)
    assert any("parameters stay as stated" in note for note in result.diagnosis.notes)
    shrunk = result.diagnosis.shrinkage
    assert shrunk is not None
    assert shrunk.rms_before == shrunk.rms_nominal == shrunk.rms_after


def test_a_re_tune_that_predicts_better_is_written(plant: BoundPlant, fly: Fly) -> None:
    result = checked_on(plant, fly, TWO_SD)
    stated, tuned = plant.plant.parameters["J_A"].value, result.plant.parameters["J_A"].value
    assert isinstance(stated, float)
    assert tuned == pytest.approx(TWO_SD * stated, rel=0.03)
    assert not any("parameters stay as stated" in note for note in result.diagnosis.notes)


SPRING = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.0, "h": 0.0}}
ASLANT = {"azimuth.tilt": {"m": 0.02, "Phi_0": 1.0}}
TILTED = {"azimuth.tilt": {"m": 0.002, "Phi_0": 1.0}}


def told_to_be_a_part(found: Diagnosis) -> list[str]:
    return [note for note in found.notes if "something else is missing" in note]


def test_an_effect_that_takes_most_of_the_hold_outs_error_is_the_whole(sprung: Result) -> None:
    found = sprung.diagnosis
    assert (found.found, told_to_be_a_part(found)) == (("azimuth.cable_spring",), [])
    assert found.unknown is not None
    assert found.unknown.probability < 0.2


@pytest.mark.soak
def test_an_effect_that_leaves_most_of_the_hold_outs_error_is_not_the_whole(plant: BoundPlant, fly: Fly) -> None:
    logs = [fly(53, SPRING, rig_seed=53), fly(54, {**SPRING, **TILTED}, rig_seed=53)]
    found = diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None])).diagnosis
    assert found.shrinkage is not None
    assert found.unknown is not None
    told = told_to_be_a_part(found)
    assert "azimuth.cable_spring" in told[0]
    assert found.unknown.probability > 0.8  # at most 22 % of the error goes
    assert found.found == ()


@pytest.mark.soak
def test_a_coarse_sensor_is_not_blamed_for_what_its_steps_leave(plant: BoundPlant, fly: Fly) -> None:
    coarse = {"psi_sensor.quantization": {"q": 0.02}}  # 13 counts: what they leave is most of the error, found or not
    logs = [fly(seed, coarse, rig_seed=55, air=False) for seed in (55, 56)]
    found = diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None])).diagnosis
    assert found.effects[0].effect == "psi_sensor.quantization"
    assert found.effects[0].probability > 0.8
    assert not told_to_be_a_part(found)


def test_the_steps_of_a_sensor_are_not_refuted_by_predictions(plant: BoundPlant, fly: Fly) -> None:
    # They make no prediction better, and a start from coarse readings is less sure; the hold-out's own readings lie on the grid.
    case = make_case(
        effect_library(plant), [fly(56, {"phi_sensor.quantization": {"q": 0.036}}, rig_seed=55, air=False)]
    )
    base = nominal_fit(case)

    def named(name: str, size: float) -> Weighed:
        effects = {name: {"q" if "quantization" in name else "offset": size}}
        wrong = replace(base, hypothesis=base.hypothesis.with_effects(effects))
        return Weighed((FittedHypothesis((name,), wrong, 1.0),), (0.9,), 0.1, 0.0, 1.0)

    holdout = Holdout(case, ["hold"], [None], FittedHypothesis((), base, 0.0))
    assert worse(holdout, named("phi_sensor.quantization", 0.036)) == 0.0
    assert worse(holdout, named("tail_input.offset", 3.0)) > 1.5
    # Nor are they told to be a part: what they leave, a step over the root of 12, is not held against them.
    first = named("phi_sensor.quantization", 0.036).fitted[0]
    told = holdout.shrinkage(holdout.predicted(first))
    left = _floor(case, first, told)
    assert left["phi_rad"] == pytest.approx(np.hypot(told.rms_floor["phi_rad"], 0.036 / np.sqrt(12.0)))
    assert left["psi_rad"] == pytest.approx(told.rms_floor["psi_rad"])


@pytest.mark.parametrize(("there", "idle"), [(True, False), (False, True)])
def test_what_takes_nothing_of_the_hold_outs_error_is_seen(
    plant: BoundPlant, fly: Fly, there: bool, idle: bool
) -> None:
    # Truth: a spring that the hold-out has, or has not; what is named is a spring a tenth as stiff as one that would show.
    case = make_case(effect_library(plant), [fly(57, SPRING if there else None, rig_seed=57)])
    base = nominal_fit(case)
    named = SPRING if there else {"azimuth.cable_spring": {"k": 4e-5, "angle_0": 0.0, "h": 0.0}}
    sprung = (
        fit(case, base.hypothesis.with_effects(named))
        if there
        else replace(base, hypothesis=base.hypothesis.with_effects(named))
    )
    assert sprung is not None
    holdout = Holdout(case, ["hold"], [None], FittedHypothesis((), base, 0.0))
    weighed = Weighed((FittedHypothesis(tuple(named), sprung, 1.0),), (0.9,), 0.1, 0.0, 1.0)
    after, notes, _ = partly(holdout, weighed, 0.0)
    assert (after.nameless, len(notes) == 1) == (idle, idle)


def test_what_leaves_most_of_the_hold_outs_error_is_a_part(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the rig that was fitted has a spring, that of the hold-out stands aslant besides, which pulls five times as much.
    train, hold = (
        make_case(effect_library(plant), [fly(seed, effects, rig_seed=53)])
        for seed, effects in ((53, SPRING), (54, {**SPRING, **ASLANT}))
    )
    base = nominal_fit(train)
    sprung = fit(train, base.hypothesis.with_effects(SPRING))
    assert sprung is not None
    weighed = Weighed((FittedHypothesis(tuple(SPRING), sprung, 1.0),), (0.9,), 0.1, 0.0, 1.0)
    for case, leaves in ((train, False), (hold, True)):
        holdout = Holdout(case, ["hold"], [None], FittedHypothesis((), base, 0.0))
        after, notes, _ = partly(holdout, weighed, 1000.0)  # where forms see something, process noise is no excuse
        assert [note.kind for note in notes] == leaves * ["something_else_missing"]
        assert (after.unknown > 0.5) is leaves  # less than half of the error goes, or all of it


def test_a_push_is_not_asked_what_it_takes_of_another_log(plant: BoundPlant, fly: Fly) -> None:
    case = make_case(effect_library(plant), [fly(58, rig_seed=57)])
    base = nominal_fit(case)
    push = {"azimuth.disturbance": {"torque": 2e-3, "t_0": 12.0, "duration": 1.0}}
    pushed = replace(base, hypothesis=base.hypothesis.with_effects(push))
    holdout = Holdout(case, ["hold"], [None], FittedHypothesis((), base, 0.0))
    weighed = Weighed((FittedHypothesis(tuple(push), pushed, 1.0),), (0.9,), 0.1, 0.0, 1.0)
    assert partly(holdout, weighed, 0.0) == (weighed, (), ())


@pytest.mark.parametrize(("instant_s", "event"), [(12.0, True), (0.0, False)])
def test_an_event_before_all_logs_is_none(plant: BoundPlant, instant_s: float, event: bool) -> None:
    # A weight that moved at the beginning of time is another weight in each log; a push has its end besides.
    effects = library(plant)
    assert happens(effects["elevation.weight_shift"], {"Delta": 0.01, "t_1": instant_s}) is event
    assert happens(effects["elevation.disturbance"], {"torque": 1e-3, "t_0": instant_s, "duration": 1.0})
    assert not happens(effects["azimuth.cable_spring"], SPRING["azimuth.cable_spring"])
