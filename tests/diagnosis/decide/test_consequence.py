"""A gap matters by what its explanation predicts, not by how certain many rows make it."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.consequence import consequence, without_idle
from diagnosis.decide.weighing import Tried, Weighed
from diagnosis.detect.detection import Detection, FormScores
from diagnosis.detect.linearisation import Scores
from diagnosis.detect.replicas import Tail
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.nominal import nominal_fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.result import Judged, Seen
from diagnosis.standing import of_consequence
from diagnosis.validate.fitted_logs import FittedLogs
from tests.diagnosis.arm import arm_case, arm_log


def explained(case: Case, plain: FittedHypothesis, effect: str, values: dict[str, float]) -> FittedHypothesis:
    found = fit(case, plain.fit.hypothesis.with_effects({effect: values}))
    assert found is not None
    return as_fitted(case, found)


def test_friction_that_holds_the_arm_matters_and_a_lag_of_a_millisecond_does_not() -> None:
    # Truth: 0.4 mN m of dry friction, which moves a prediction by many counts; the arm reads 1 ms late, a fifth of a count in usual motion.
    gains = []
    for effect, values in (("arm.coulomb", {"b": 4e-4}), ("theta_sensor.delay", {"tau": 1e-3, "jitter": 0.0})):
        case = arm_case(arm_log({effect: values}, seed=76))
        plain = as_fitted(case, nominal_fit(case))
        (rule,) = consequence(case, plain, [explained(case, plain, effect, values)], [1.0])
        gains.append(rule.value)
        assert rule.of == effect
    assert gains[0] is not None
    assert gains[1] is not None
    assert gains[0] > 0.3
    assert gains[1] < 0.05


def test_what_was_not_tried_is_not_asked() -> None:
    case = arm_case(arm_log(seed=76))
    assert consequence(case, as_fitted(case, nominal_fit(case)), [], []) == ()


def settled(case: Case, effects: dict[str, dict[str, float]]) -> FittedHypothesis:
    """A fit of effects with the noise that then remains."""
    found = fit(case, nominal_hypothesis(case, -1.5).with_effects(effects))
    assert found is not None
    ended = fit(case, with_process_noise(case, found.hypothesis))
    assert ended is not None
    return as_fitted(case, ended)


def surely(fitted: FittedHypothesis) -> FittedHypothesis:
    """The same so likely that it is asked what it predicts, whatever a further effect costs by the learned law."""
    return replace(fitted, evidence=fitted.evidence + 1e4)


def test_an_effect_that_predicts_no_better_is_left_out_and_one_that_does_stays() -> None:
    # Truth: dry friction and a scale of the sensor that is off by a thousandth, which no prediction shows.
    rub, idle = {"arm.coulomb": {"b": 4e-4}}, {"theta_sensor.scale": {"scale": 1.001}}
    case = arm_case(arm_log({**rub, **idle}, seed=76))
    both, alone, other = (settled(case, effects) for effects in ({**rub, **idle}, rub, idle))
    both = surely(both)
    tried = Tried((both, alone), settled(case, {}), case.library, 5.0)
    logs = FittedLogs(case)
    found, (rule,) = without_idle(logs, tried)
    assert [entry.effects for entry in found.named] == [("arm.coulomb",)]
    assert rule.value is not None
    assert rule.value < 0.05
    # Where nothing else was tried with one effect less, the friction would be missed.
    kept, rules = without_idle(logs, replace(tried, named=(other, both)))
    assert kept.named == (other, both)
    assert [one.outcome for one in rules] == ["arm.coulomb matters"]


def test_an_effect_that_does_a_small_part_of_what_its_fellow_does_is_left_out() -> None:
    # Truth: dry friction of 0.4 mN m and a thirteenth of that as a constant force: certain, and less than friction's form may be off.
    rub, pull = {"arm.coulomb": {"b": 4e-4}}, {"arm.offset_force": {"offset": 3e-5}}
    case = arm_case(arm_log({**rub, **pull}, seed=76))
    both, alone, plain = (settled(case, effects) for effects in ({**rub, **pull}, rub, {}))
    both = surely(both)
    found, (rule,) = without_idle(FittedLogs(case), Tried((both, alone), plain, case.library, 5.0))
    assert found.named == (alone,)
    assert rule.value is not None
    assert rule.limit is not None
    assert decisions.MATTERS < rule.value < rule.limit
    # Beside a plant that predicts as well but for the force it is all that there is.
    found, _ = without_idle(FittedLogs(case), Tried((both, alone), alone, case.library, 5.0))
    assert found.named == (both, alone)


def test_an_effect_whose_part_parameters_take_only_beyond_their_spread_is_not_idle() -> None:
    # Truth: the same small force. Without it a parameter stands nine standard deviations from its file, which costs 18 nats.
    rub, pull = {"arm.coulomb": {"b": 4e-4}}, {"arm.offset_force": {"offset": 3e-5}}
    case = arm_case(arm_log({**rub, **pull}, seed=76))
    both, alone, plain = (settled(case, effects) for effects in ({**rub, **pull}, rub, {}))
    theta = alone.fit.hypothesis.theta.copy()
    theta[0] = 9.0
    bent = replace(alone, fit=replace(alone.fit, hypothesis=replace(alone.fit.hypothesis, theta=theta)))
    both = surely(both)
    found, rules = without_idle(FittedLogs(case), Tried((both, bent), plain, case.library, 5.0))
    assert found.named == (both, bent)
    assert [(rule.rule, rule.value) for rule in rules] == [("parameters_instead", pytest.approx(18.0))]


@pytest.mark.parametrize("moved", [False, True])
def test_what_changes_no_prediction_matters_where_the_plant_had_to_leave_its_file(moved: bool) -> None:
    # Truth: a reading late by 1 ms, which no prediction shows. A plant that follows its logs as stated lacks nothing that matters.
    values = {"tau": 1e-3, "jitter": 0.0}
    case = arm_case(arm_log({"theta_sensor.delay": values}, seed=76))
    plain = as_fitted(case, nominal_fit(case))
    late = explained(case, plain, "theta_sensor.delay", values)
    empty = Scores(np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    detection = Detection(1e-9, Tail(5.0, 1.0), 100.0, moved, FormScores((), empty, np.zeros(0)))
    seen = Seen(case, None, plain, object(), (), None, detection)  # type: ignore[arg-type]
    weighed = Weighed((late,), (0.9,), 0.1, 0.0, 10.0)
    judged = Judged(object(), None, weighed, late, None, ())  # type: ignore[arg-type]
    assert of_consequence(seen, judged)[1] is moved
