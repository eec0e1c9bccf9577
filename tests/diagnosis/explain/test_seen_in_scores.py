"""What scores show of an input's steps, what logs could have shown at all, and which stated numbers a fit moved."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.detect.input_steps import Kind, likely_steps
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import ScoreTest
from diagnosis.explain.visibility import cannot_tell, hidden, judged
from diagnosis.fit.moved import moved_effects, moved_parameters
from diagnosis.fit.nominal import best_plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from records.plant import load_plant
from sim.added_effects import with_effects
from sim.bind import bind
from sim.columns import log_columns
from sim.simulate import Conditions, simulate
from tests.diagnosis.arm import arm, arm_case, arm_log, plain_linearisation
from tests.diagnosis.nominal import nominal_fit
from tests.soak import SOAK
from tests.test_project import ROOT

STEP_V = 0.2


def test_steps_of_an_input_are_found_near_their_size() -> None:
    # Truth: the rig rounds its command to 0.2 V. Candidates lie half a percent apart, so one must lie within 1 %.
    case = arm_case(arm_log({"input.quantization": {"q": STEP_V}}))
    found = likely_steps(linearised(case, nominal_fit(case)), "input")
    assert min(abs(step / STEP_V - 1.0) for step, _ in found) < 0.01


@pytest.mark.soak
def test_steps_of_an_input_that_no_rotor_stands_behind_are_found() -> None:
    # Truth: a motor, whose voltage moves a current and that the shaft, gets it rounded to 0.1 V; the current settles within 1 ms of a row.
    motor = bind(load_plant(ROOT / "plants" / "dc_motor" / "plant.toml"))
    t_s = np.arange(0.0, 40.0 if SOAK else 20.0, 0.02)
    rates, phases = np.random.default_rng(7).uniform((0.5, 0.0), (6.0, 6.3), (5, 2)).T
    u = 0.5 * np.sin(np.outer(t_s, rates) + phases).sum(axis=1)[:, None]
    rig = with_effects(motor, {"input.quantization": {"q": 0.1}})
    run = simulate(rig, t_s, np.zeros(3), u, Conditions(substeps=40, keep="y"))
    case = make_case(effect_library(motor), [RunLog(log_columns(motor.model), 0.02, "open", t_s, u, run.y)])
    found = likely_steps(linearised(case, nominal_fit(case)), "input")
    assert min(abs(step / 0.1 - 1.0) for step, _ in found) < 0.01


@pytest.mark.soak
def test_steps_of_a_command_that_takes_a_hundredth_of_its_range_are_found() -> None:
    # Truth: a drone whose torque command may go to 1 and goes to 0.01 gets it rounded to 0.003: a step smaller than any of the whole range.
    drone = bind(load_plant(ROOT / "plants" / "antx_2dof_drone.toml"))
    t_s = np.arange(0.0, 20.0 if SOAK else 10.0, 0.004)
    rates, phases = np.random.default_rng(7).uniform((0.5, 0.0), (6.0, 6.3), (5, 2)).T
    u = 0.003 * np.sin(np.outer(t_s, rates) + phases).sum(axis=1)[:, None]
    rig = with_effects(drone, {"input.quantization": {"q": 0.003}})
    run = simulate(rig, t_s, np.zeros(4), u, Conditions(substeps=4, keep="y"))
    case = make_case(effect_library(drone), [RunLog(log_columns(drone.model), 0.004, "open", t_s, u, run.y)])
    found = likely_steps(linearised(case, best_plain_fit(case)), "input")
    assert min(abs(step / 0.003 - 1.0) for step, _ in found) < 0.01


@pytest.mark.parametrize(("shape", "kind"), [({"h": 0.15}, Kind(hold=0.12)), ({"s": 0.3}, Kind(shift=0.25))])
def test_steps_that_hold_or_lie_elsewhere_are_found_near_their_size_with_what_they_are_like(
    shape: dict[str, float], kind: Kind
) -> None:
    # Truth: the rig holds its steps of 0.2 V by 0.15 of one beyond their half, or has them 0.3 of one below the multiples; of the kinds
    # that are tried the one near it must win.
    case = arm_case(arm_log({"input.quantization": {"q": STEP_V, **shape}}))
    kinds = (Kind(), Kind(hold=0.12), Kind(shift=0.25), Kind(shift=0.5), Kind(shift=-0.25))
    found = likely_steps(linearised(case, nominal_fit(case)), "input", kinds)
    step, told = min(found, key=lambda entry: abs(entry[0] / STEP_V - 1.0))
    assert abs(step / STEP_V - 1.0) < 0.01
    assert told == kind


def test_one_pass_backwards_tells_how_any_disturbance_of_a_state_meets_the_innovations() -> None:
    # Truth: E'w with E the filter's own answer to a disturbance drawn at random, to rounding of some thousand sums.
    linearisation = plain_linearisation()
    rng = np.random.default_rng(5)
    pushes = [rng.normal(size=len(filter_input.t_s)) for filter_input in linearisation.filter_inputs]
    states = len(linearisation.case.library.bound.model.states)
    for target in range(states):
        answer = linearisation.answer([lambda part, push=push: push[part, None] for push in pushes], target)
        pulls = linearisation.pulls(np.eye(states)[target])
        met = sum(float(pull @ push) for pull, push in zip(pulls, pushes, strict=True))
        assert met == pytest.approx(float(answer[:, 0] @ linearisation.w), rel=1e-9)


def scored(effect: str, power: float) -> ScoreTest:
    return ScoreTest(effect, {}, 0.0, 0.0, 0.0, power)


def test_data_cannot_tell_where_most_of_the_library_would_go_unseen() -> None:
    case = plain_linearisation().case
    loud = [scored(name, 8.0) for name in case.library.candidates]
    assert hidden(case, loud) == {}
    assert not cannot_tell(case, loud)
    quiet = [replace(entry, power=1.0) for entry in loud]
    # Truth: a size is certain at 3 sd, so what scores 1 at its reference size would have to be 3 times as large.
    assert set(hidden(case, quiet).values()) == {3.0}
    assert cannot_tell(case, quiet)
    assert judged(case, loud) == list(case.library.candidates)
    assert all(ratio == np.inf for ratio in hidden(case, []).values())


def test_numbers_that_left_their_spread_are_told_furthest_first() -> None:
    linearisation = plain_linearisation()
    assert moved_parameters(np.array([0.5, -4.0, 3.5]), 3.0) == [1, 2]
    assert moved_effects(linearisation.fit, 3.0) == []  # the plant file states no effect


@pytest.mark.parametrize("far", [1.0, 100.0])
def test_a_plain_run_moves_nothing_far(far: float) -> None:
    linearisation = plain_linearisation()
    theta = linearisation.fit.hypothesis.theta
    assert len(moved_parameters(theta, far)) == int((np.abs(theta) > far).sum())


def test_where_nothing_is_uncertain_effects_are_still_scored() -> None:
    # Truth: 0.4 mN m of dry friction in an arm all of whose parameters are known exactly; no coefficient can take a part of it.
    plant = arm().plant
    sure = {
        name: replace(entry, sd=tuple(0.0 for _ in entry.values) if isinstance(entry.value, tuple) else 0.0)
        for name, entry in plant.parameters.items()
    }
    known = bind(replace(plant, parameters=sure))
    case = make_case(effect_library(known), [arm_log({"arm.coulomb": {"b": 4e-4}})])
    best = score_effects(case, linearised(case, nominal_fit(case)), ["arm.coulomb"])[0]
    assert best.absorbed == pytest.approx(0.0, abs=1e-9)
    assert best.gain > 20.0
