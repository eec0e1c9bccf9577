"""A gap matters by what its explanation predicts, not by how certain many rows make it."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.confirmation import of_consequence
from diagnosis.decide.consequence import foreseen, foreseen_rules
from diagnosis.decide.weighing import Explanations, Weighed, weigh
from diagnosis.detect.detection import Detection
from diagnosis.detect.form_scores import FormScores
from diagnosis.detect.linearisation import Scores
from diagnosis.detect.replicas import Tail
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from diagnosis.result import Exit, Judged, Seen
from diagnosis.validate.fitted_logs import FittedLogs
from tests.diagnosis.arm import arm_case, arm_log, settled
from tests.diagnosis.nominal import nominal_fit


def explained(case: Case, plain: FittedHypothesis, effect: str, values: dict[str, float]) -> FittedHypothesis:
    """The fit of an effect from the plant as stated, which is the truth: that of a plant bent to do without lies behind hills."""
    begun = replace(plain.fit.hypothesis, theta=np.zeros_like(plain.fit.hypothesis.theta))
    found = fit(case, begun.with_effects({effect: values}))
    assert found is not None
    return as_fitted(case, found)


def seen(case: Case, plain: FittedHypothesis, largest: float = 100.0, moved: bool = False) -> Seen:
    """A gap of so many nats."""
    empty = Scores(np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    detection = Detection(1e-9, Tail(5.0, 1.0), largest, moved, FormScores((), empty, np.zeros(0)))
    return Seen(case, None, plain, object(), (), None, detection)  # type: ignore[arg-type]


def judged(found: FittedHypothesis | None, ahead_nats: float | None) -> Judged:
    """What is made of a gap that one hypothesis, or nothing, explains."""
    weighed = Weighed(() if found is None else (found,), (0.9,), 0.1, 0.0, 10.0, ahead_nats=ahead_nats)
    return Judged(object(), None, None, weighed, found, None, ())  # type: ignore[arg-type]


def weighed_of(case: Case, plain: FittedHypothesis, found: FittedHypothesis) -> Weighed:
    explanations = Explanations((found,), plain, case.library, 5.0)
    return weigh(explanations, foreseen(FittedLogs(case), explanations))


def test_friction_that_holds_the_arm_matters_and_a_lag_of_a_millisecond_does_not() -> None:
    # Truth: 0.4 mN m of dry friction, which moves a prediction by many counts; the arm reads 1 ms late, a fifth of a count in usual motion.
    for effect, values, matters in (
        ("arm.coulomb", {"b": 4e-4}, True),
        ("theta_sensor.delay", {"tau": 1e-3, "jitter": 0.0}, False),
    ):
        case = arm_case(arm_log({effect: values}, seed=76))
        plain = as_fitted(case, nominal_fit(case))
        found = explained(case, plain, effect, values)
        weighed = weighed_of(case, plain, found)
        assert weighed.ahead_nats is not None
        assert (weighed.ahead_nats > 0.3 * FittedLogs(case).readings) is matters
        result = replace(judged(found, None), weighed=weighed)
        after, left_by = of_consequence(seen(case, plain), result)
        assert left_by is (None if matters else Exit.TOO_SMALL)
        assert (after.decisions[-1].rule, after.decisions[-1].of) == ("matters", effect)


@pytest.mark.parametrize(
    ("largest", "ahead_nats", "left_by"),
    [
        (20.0, 0.1, Exit.TOO_SMALL),
        (20.0, 5.0, Exit.TOO_UNSURE),
        (20.0, 10.0, None),
        (20.0, None, Exit.TOO_SMALL),
        (200.0, 0.1, Exit.TOO_SMALL),
        (200.0, 5.0, None),
        (200.0, None, None),
    ],
)
def test_a_small_gap_needs_predictions_that_are_better_than_chance(
    largest: float, ahead_nats: float | None, left_by: Exit | None
) -> None:
    # Truth by hand: 5 nats have a chance of exp(-5) = 7e-3 without a gap, 10 nats one of 5e-5; a gap may stand at 1e-3. What matters are
    # 0.04 nats a second of some ten seconds: less is nothing, more that chance may make is unsure. A large gap that nothing explains
    # stands, as that of an unknown effect.
    case = arm_case(arm_log({"arm.coulomb": {"b": 4e-4}}, seed=76))
    plain = as_fitted(case, nominal_fit(case))
    found = None if ahead_nats is None else plain
    assert of_consequence(seen(case, plain, largest), judged(found, ahead_nats))[1] is left_by


def test_what_is_there_predicts_the_logs_better_and_what_is_idle_does_not() -> None:
    # Truth: 0.4 mN m of dry friction; a scale of the sensor that is off by a thousandth, which no prediction shows.
    rub, idle = {"arm.coulomb": {"b": 4e-4}}, {"theta_sensor.scale": {"scale": 1.001}}
    case = arm_case(arm_log({**rub, **idle}, seed=76))
    both, alone, other, plain = (settled(case, effects) for effects in ({**rub, **idle}, rub, idle, {}))
    logs = FittedLogs(case)
    found = foreseen(logs, Explanations((both, alone, other), plain, case.library, 5.0))
    assert found[alone] > 0.3 * logs.readings
    assert found[other] < 0.1 * found[alone]
    assert abs(found[both] - found[alone]) < decisions.MATTERS * logs.readings


def test_a_second_effect_predicts_what_the_first_leaves() -> None:
    # Truth: dry friction and a constant force of half of it.
    rub, pull = {"arm.coulomb": {"b": 4e-4}}, {"arm.offset_force": {"offset": 2e-4}}
    case = arm_case(arm_log({**rub, **pull}, seed=76))
    both, alone, plain = (settled(case, effects) for effects in ({**rub, **pull}, rub, {}))
    found = foreseen(logs := FittedLogs(case), Explanations((alone, both), plain, case.library, 5.0))
    assert found[both] - found[alone] > decisions.MATTERS * logs.readings
    weighed = Weighed((both, alone), (0.6, 0.01), 0.39, 0.0, 1.0)
    (rule,) = foreseen_rules(found, weighed)  # what is unlikely is not told
    assert (rule.of, rule.value) == ("arm.coulomb + arm.offset_force", pytest.approx(found[both]))


@pytest.mark.parametrize(
    ("moved", "furthest_sd", "stands"), [(False, 4.0, False), (True, 2.0, False), (True, 4.0, True)]
)
def test_what_changes_no_prediction_matters_where_the_plant_had_to_leave_its_file(
    moved: bool, furthest_sd: float, stands: bool
) -> None:
    # Truth: a reading late by 1 ms, which no prediction shows. A plant that follows its logs within its spread lacks nothing that matters.
    values = {"tau": 1e-3, "jitter": 0.0}
    case = arm_case(arm_log({"theta_sensor.delay": values}, seed=76))
    plain = as_fitted(case, nominal_fit(case))
    late = explained(case, plain, "theta_sensor.delay", values)
    result = replace(judged(late, None), weighed=weighed_of(case, plain, late))
    theta = np.full_like(plain.fit.hypothesis.theta, furthest_sd)
    bent = replace(plain, fit=replace(plain.fit, hypothesis=replace(plain.fit.hypothesis, theta=theta)))
    assert (of_consequence(seen(case, bent, moved=moved), result)[1] is None) is stands


def test_the_likeliest_are_asked_and_not_those_that_gain_most_by_a_plant_far_from_its_own() -> None:
    # Truth: dry friction. As many names as are asked gain more evidence, each with a parameter twenty standard deviations from what is
    # stated, which costs (20 - 3)^2 / 2 nats that no scale lessens: the friction is likelier than all of them.
    case = arm_case(arm_log({"arm.coulomb": {"b": 4e-4}}, seed=76))
    plain, rub = settled(case, {}), settled(case, {"arm.coulomb": {"b": 4e-4}})
    other = rub.fit.hypothesis.with_effects({"arm.stribeck": {"b_s": 4e-4, "v_s": 0.1, "e": 0.0}})
    astray = replace(rub.fit, hypothesis=replace(other, theta=np.full_like(other.theta, 20.0)))
    far = [
        FittedHypothesis(("arm.stribeck",), astray, rub.evidence + 1.0 + number)
        for number in range(decisions.most_asked())
    ]
    found = foreseen(FittedLogs(case), Explanations((*far, rub), plain, case.library, 5.0))
    assert rub in found
    assert found[rub] > 0.0
