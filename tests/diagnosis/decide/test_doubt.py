"""Logs of two plants contradict each other, logs of nothing are not known by any plant: no cause is named then."""

from dataclasses import replace

import numpy as np

from diagnosis.decide.contradiction import contradiction
from diagnosis.decide.doubt import Doubt, contradicting
from diagnosis.decide.weighing import Weighed
from diagnosis.hypothesis.case import Case
from diagnosis.validate.misfit import ignorance
from records.log import RunLog
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

SPRING = {"arm.cable_spring": {"k": 3e-3, "angle_0": 0.0, "h": 0.0}}


def part(log: RunLog, rows: slice) -> RunLog:
    return replace(log, t_s=log.t_s[rows], u=log.u[rows], y=log.y[rows])


def gain_of_own_numbers(case: Case) -> float:
    found = contradiction(case, nominal_fit(case))
    assert found is not None
    return found.gain


def test_two_parts_of_one_run_agree_and_runs_of_two_plants_do_not() -> None:
    # About ten numbers of its own gain a log half a nat each by chance; a spring that only one of two plants has gains several times
    # that, whatever part of it noise with a memory takes.
    run = arm_log(seed=41)
    agreeing = arm_case(part(run, slice(0, 700)), part(run, slice(700, 1400)))
    assert gain_of_own_numbers(agreeing) < 15.0
    differing = arm_case(run, arm_log(SPRING, seed=42))
    assert gain_of_own_numbers(differing) > 60.0
    assert contradiction(arm_case(run), nominal_fit(agreeing)) is None


def test_a_hold_out_of_another_rig_is_told_though_each_is_as_stated() -> None:
    # Truth: a lever of 0.1 m is known to 0.03 m; that of the third log is 0.09 m.
    one, same, other = arm_log(seed=71), arm_log(seed=72), arm_log(seed=73, l=0.09)
    alike, unlike = arm_case(one, same), arm_case(one, other)
    assert contradicting(alike, nominal_fit(alike).hypothesis, ["train", "hold"])[0] == ()
    (told,), _ = contradicting(unlike, nominal_fit(arm_case(one)).hypothesis, ["train", "hold"])
    assert (told.kind, told.numbers["gain_nats"] > 150.0) == ("contradiction", True)


def test_a_plant_knows_its_own_runs_and_nothing_of_a_random_walk() -> None:
    # Errors over those of holding the last reading: a small share where the plant is right, 1 where nothing can be known.
    run = arm_log(seed=43)
    known = arm_case(run)
    assert max(ignorance(known, nominal_fit(known).hypothesis).values()) < 0.2
    walk = np.cumsum(np.random.default_rng(3).normal(0.0, 0.004, run.y.shape), axis=0)
    unknown = arm_case(replace(run, y=np.clip(walk, -0.7, 0.7)))
    found = ignorance(unknown, nominal_fit(unknown).hypothesis)
    assert min(found.values()) > 0.9


def test_an_output_that_stands_says_nothing_of_what_is_known() -> None:
    run = arm_log(seed=43)
    case = arm_case(replace(run, y=np.full_like(run.y, 0.1)))
    assert ignorance(case, nominal_fit(case).hypothesis) == {}


def test_a_doubt_that_forbids_names_leaves_all_to_the_unknown() -> None:
    weighed = Weighed((), (0.7, 0.2), unknown=0.02, retune=0.05, scale=4.0, partly=0.03)
    assert Doubt((), (), forbids=False).applied(weighed) is weighed
    doubted = Doubt((), (), forbids=True).applied(weighed)
    assert (doubted.probabilities, doubted.partly, doubted.retune, doubted.unknown) == ((0.0, 0.0), 0.0, 0.0, 1.0)
