"""The next experiment, flown in advance: what the physics says must tell two effects apart does, and what cannot does not."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.decide.weighing import Weighed
from diagnosis.experiment.menu import gravity_parameters, plans
from diagnosis.experiment.next_experiment import next_experiment
from diagnosis.experiment.simulated_experiment import missed, outcomes, recorded, setting, simulate_experiment
from diagnosis.experiment.stand_in import stand_in, steered
from diagnosis.fit.evidence import FittedHypothesis, log_evidence
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from tests.diagnosis.conftest import Fly
from tests.own_plants import TWO_AXES, WORKING
from tests.plants import bound

SPRING = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.2, "h": 0.0}}
TILT = {"azimuth.tilt": {"m": 0.005, "Phi_0": 0.15, "e": 0.0}}
PERIOD_S = 0.02


@pytest.fixture(scope="module")
def case(plant: BoundPlant, fly: Fly) -> Case:
    return make_case(effect_library(plant), [fly(11, SPRING, seconds=15.0)])


def as_found(case: Case, effects: Mapping[str, Mapping[str, float]]) -> FittedHypothesis:
    start = with_process_noise(case, nominal_hypothesis(case, -1.5).with_effects(effects))
    found = fit(case, start, rounds=5)
    assert found is not None
    return FittedHypothesis(tuple(effects), found, log_evidence(found, case.library.effects))


def weighed(*fitted: FittedHypothesis) -> Weighed:
    return Weighed(fitted, tuple(1.0 / len(fitted) for _ in fitted), 0.0, 0.0, 4.0)


@pytest.fixture(scope="module")
def spring(case: Case) -> FittedHypothesis:
    return as_found(case, SPRING)


@pytest.fixture(scope="module")
def tilt(case: Case) -> FittedHypothesis:
    return as_found(case, TILT)


def test_a_wide_sweep_tells_a_spring_from_a_tilted_base(
    case: Case, spring: FittedHypothesis, tilt: FittedHypothesis
) -> None:
    # Truth: over small angles both pull back in proportion; a spring goes on growing where gravity's part turns over.
    found = next_experiment(case, weighed(spring, tilt))
    assert found is not None
    assert found["experiment"] == "wide azimuth sweep"
    assert found["separates"] == ["azimuth.cable_spring from azimuth.tilt"]
    assert found["separation"] > 20.0
    assert found["within_limits"]
    assert "the azimuth is at" in found["expected_outcome"]
    assert next_experiment(case, weighed(spring, tilt)) == found


def test_with_the_azimuth_locked_nothing_on_it_can_show(
    case: Case, spring: FittedHypothesis, tilt: FittedHypothesis
) -> None:
    z = separations(case, spring, tilt)
    assert z["azimuth locked"] < 2.0
    assert z["rig turned by 90 degrees"] < 2.0
    assert z["wide azimuth sweep"] > 20.0
    assert z["wide azimuth sweep"] > z["slow ramp"]


def separations(case: Case, one: FittedHypothesis, other: FittedHypothesis) -> dict[str, float]:
    """z of every plan of the menu on what `one` records."""
    found = {}
    for plan in plans(case, PERIOD_S):
        law = stand_in(case.library.bound, {}, np.array([0.1, 0.2]), PERIOD_S, plan.locked)
        assert law is not None
        there = setting(case, plan)
        flown = simulate_experiment(there, plan, law, one.fit.hypothesis)
        assert flown is not None
        data, noisy = recorded(there, flown), one.fit.hypothesis
        own, missing = (missed(data, fitted.fit, plan, noisy) for fitted in (one, other))
        assert own is not None
        assert missing is not None
        found[plan.name] = float(np.sqrt(max(missing - own, 0.0)))
    return found


def test_two_names_of_one_torque_are_not_said_to_be_told_apart(case: Case, tilt: FittedHypothesis) -> None:
    # Truth: a tilted base and a steady force of 1e-9 N m turn the azimuth as the tilted base alone does, in every run.
    hypothesis = tilt.fit.hypothesis
    both = {**hypothesis.effects, "azimuth.offset_force": {"offset": 1e-9}}
    pair = FittedHypothesis(tuple(both), replace(tilt.fit, hypothesis=hypothesis.with_effects(both)), tilt.evidence)
    found = next_experiment(case, weighed(tilt, pair))
    assert found is not None
    assert found["experiment"] == "none of the menu"
    assert found["separates"] == []
    told = "no run of the menu tells azimuth.tilt from azimuth.tilt + azimuth.offset_force"
    assert found["expected_outcome"].startswith(told)


def test_what_to_look_for_lies_before_an_axis_runs_away(fly: Fly) -> None:
    # Truth: from 1 s on the azimuth turns at 9 rad/s in one run, a whole turn by 1.698 s; the elevation is 0.2 rad higher up to 0.5 s.
    still = fly(11, {}, seconds=4.0)
    since_s = still.t_s - still.t_s[0]
    moved = np.zeros_like(still.y)
    moved[:, 0], moved[:, 1] = np.where(since_s < 0.5, 0.2, 0.0), 9.0 * np.maximum(since_s - 1.0, 0.0)
    still = replace(still, y=np.zeros_like(still.y))
    found = outcomes([still, replace(still, y=moved)], {"psi_rad": 0.001, "phi_rad": 0.1})
    assert found == ("psi_rad", 0.0, (0.0, 0.2))
    name, after_s, values = outcomes([still, replace(still, y=moved)], {"phi_rad": 0.1}) or ("", 0.0, ())
    assert (name, after_s) == ("phi_rad", pytest.approx(1.69))
    assert max(values) < 2.0 * np.pi


def test_nothing_undecided_asks_for_nothing(case: Case, spring: FittedHypothesis, tilt: FittedHypothesis) -> None:
    sure = Weighed((spring, tilt), (0.995, 0.001), 0.004, 0.0, 4.0)
    assert next_experiment(case, sure) is None


@pytest.mark.parametrize(("name", "coefficients"), [("ce150", ("tau_gE",)), ("aeroshield", ("g",)), ("emps", ())])
def test_gravity_is_taken_out_by_what_is_gravity_alone(name: str, coefficients: tuple[str, ...]) -> None:
    # Truth by the equations: AeroShield's l and m also make its lever and inertia, EMPS moves level.
    assert gravity_parameters(bound(name).model) == coefficients


def test_an_axis_that_nobody_reads_follows_no_reference(tmp_path: Path) -> None:
    # Truth: of a motor that turns a load through a spring the motor's angle alone is read, and one input turns it.
    elastic = bind(load_plant(WORKING["elastic"].write(tmp_path, "elastic")))
    assert [axis.name for axis in steered(elastic.model)] == ["motor"]
    law = stand_in(elastic, {}, np.array([0.1]), PERIOD_S)
    assert law is not None
    assert [str(elastic.model.states[place]) for place in law.tracked] == ["theta_rad"]


def test_the_stand_in_law_holds_an_unstable_plant_along_its_references(case: Case) -> None:
    # Truth: without a law the arm falls to its stop, 0.79 rad away; with it, each axis follows a slow ramp a little late.
    law = stand_in(case.library.bound, {}, np.array([0.1, 0.2]), PERIOD_S)
    assert law is not None
    plan = next(plan for plan in plans(case, PERIOD_S) if plan.name == "slow ramp")
    flown = simulate_experiment(case, plan, law, nominal_hypothesis(case, -4.0))
    assert flown is not None
    assert flown.within_limits
    assert np.abs(flown.log.y - plan.course.reference)[100:].max() < 0.15


def test_a_rotor_s_speed_is_known_by_its_place_whatever_its_name(plant: BoundPlant, tmp_path: Path) -> None:
    # Truth: the boom's rotor has a state of its own, called w_V; the post's pushes as its input says.
    boom = bind(load_plant(TWO_AXES.write(tmp_path, "boom")))
    assert effect_library(boom).rotor_speeds == ("w_V",)
    assert effect_library(plant).rotor_speeds == ("omega_M_rad_s", "omega_T_rad_s")
    log = RunLog(log_columns(boom.model), 0.01, "open", np.arange(300) * 0.01, np.zeros((300, 2)), np.zeros((300, 2)))
    menu = {plan.name: plan.instruction for plan in plans(make_case(effect_library(boom), [log]), PERIOD_S)}
    assert menu["rotor speeds logged"] == "repeat a lively run with w_V in the log"
