"""A push that comes at another instant in each log is one cause, with an instant and a size of its own in each."""

import numpy as np
import pytest

from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import ELSEWHERE, passes
from diagnosis.search.own_events import with_own_events
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

PUSH = "arm.disturbance"
PUSHES = ({"torque": 4e-4, "t_0": 6.0, "duration": 1.6}, {"torque": -6e-4, "t_0": 12.5, "duration": 1.2})


@pytest.fixture(scope="module")
def pushed() -> tuple[Case, FittedHypothesis]:
    """Two logs with a push each, and what explains the first's alone, as if both had it."""
    case = arm_case(*(arm_log({PUSH: push}, seed=seed) for seed, push in enumerate(PUSHES, 21)))
    base = nominal_fit(case).hypothesis
    found = fit(case, base.with_effects({PUSH: PUSHES[0]}))
    assert found is not None
    return case, as_fitted(case, found)


def test_each_log_gets_its_own_instant_and_size(pushed: tuple[Case, FittedHypothesis]) -> None:
    case, shared = pushed
    own = with_own_events(case, shared)
    assert own.evidence > shared.evidence + 20.0
    values = own.fit.hypothesis.own[PUSH]
    for log, truth in enumerate(PUSHES):
        assert values[log]["t_0"] == pytest.approx(truth["t_0"], abs=0.05)
        assert values[log]["torque"] == pytest.approx(truth["torque"], rel=0.1)
    assert own.fit.hypothesis.effects[PUSH] is values[0]


def test_another_log_has_none_of_them(pushed: tuple[Case, FittedHypothesis]) -> None:
    case, shared = pushed
    hypothesis = with_own_events(case, shared).fit.hypothesis
    further = arm_case(arm_log(seed=30))
    (flight,) = further.flights
    assert hypothesis.over(case.flights[1]).effects[PUSH]["t_0"] == pytest.approx(12.5, abs=0.05)
    elsewhere = hypothesis.own[PUSH][ELSEWHERE]
    assert elsewhere["torque"] == 0.0
    runs = [
        passes(further.with_flights([flight]), one)
        for one in (hypothesis.with_own(PUSH, {ELSEWHERE: elsewhere, 9: PUSHES[0]}),)
    ]
    plain = passes(further, hypothesis.with_effects({}))
    assert runs[0] is not None
    assert plain is not None
    assert runs[0][0].log_likelihood == pytest.approx(plain[0].log_likelihood, abs=0.5)


def test_the_slopes_of_numbers_by_log_are_those_of_differences(pushed: tuple[Case, FittedHypothesis]) -> None:
    # Truth: central differences of the log posterior by each own number, at a point off the optimum.
    case, shared = pushed
    own = with_own_events(case, shared).fit.hypothesis.with_value(PUSH, "torque", 5e-4, 0)
    at = fit(case, own, rounds=0)
    assert at is not None
    count = len(at.hypothesis.theta)
    rows = [(row, entry) for row, entry in enumerate(at.free, count) if entry.parameter.symbol == "torque"]
    assert [entry.log for _, entry in rows] == [0, 1]
    for row, entry in rows:
        step = 1e-3 * entry.scale
        sides = [
            fit(case, own.with_value(PUSH, "torque", entry.of(own) + side * step, entry.log), rounds=0)
            for side in (-1.0, 1.0)
        ]
        assert sides[0] is not None
        assert sides[1] is not None
        slope = (sides[0].log_posterior - sides[1].log_posterior) / (2.0 * 1e-3)
        assert at.pull[row] == pytest.approx(slope, rel=0.05, abs=0.2 * np.sqrt(at.information[row, row]))


def test_one_log_alone_keeps_what_it_has(pushed: tuple[Case, FittedHypothesis]) -> None:
    case, shared = pushed
    assert with_own_events(case.with_flights(case.flights[:1]), shared) is shared
