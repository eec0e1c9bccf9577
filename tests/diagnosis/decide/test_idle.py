"""An effect earns its name by what it predicts beside the others: in one output at least, and surely so."""

from dataclasses import replace

import pytest

from diagnosis.decide.consequence import foreseen
from diagnosis.decide.holdout import holdout_of
from diagnosis.decide.idle import Said, shares_of, without_idle
from diagnosis.decide.weighing import Explanations, weigh
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from diagnosis.validate.fitted_logs import FittedLogs
from tests.diagnosis.arm import arm_case, arm_log, settled

RUB, PULL = {"arm.coulomb": {"b": 4e-4}}, {"arm.offset_force": {"offset": 3e-5}}
SURE = 0.1  # standard error, nats: next to nothing


@pytest.fixture(scope="module")
def pulled_case() -> Case:
    return arm_case(arm_log(PULL, seed=76))


@pytest.fixture(scope="module")
def fitted(pulled_case: Case) -> tuple[FittedHypothesis, ...]:
    """Friction with the force, each alone, and the plant."""
    return tuple(settled(pulled_case, effects) for effects in ({**RUB, **PULL}, RUB, PULL, {}))


def test_an_effect_that_predicts_worse_is_left_out_whatever_its_evidence() -> None:
    # Truth: dry friction alone. A scale of the sensor that is a tenth off predicts worse, whatever evidence it be said to have; beside it
    # the friction is not idle, as nothing else was tried with one effect less.
    case = arm_case(arm_log(RUB, seed=76))
    alone, plain = settled(case, RUB), settled(case, {})
    wrong = alone.fit.hypothesis.with_effects({**RUB, "theta_sensor.scale": {"scale": 1.1}})
    both = FittedHypothesis(("arm.coulomb", "theta_sensor.scale"), replace(alone.fit, hypothesis=wrong), 1e6)
    explanations, logs = Explanations((both, alone), plain, case.library, 5.0), FittedLogs(case)
    found, (rule,) = without_idle(explanations, shares_of(explanations, foreseen(logs, explanations), logs, None))
    assert found.named == (alone,)
    assert (rule.of, rule.outcome) == ("arm.coulomb + theta_sensor.scale", "theta_sensor.scale is left out")
    assert without_idle(explanations, shares_of(explanations, [both], logs, None))[0].named == (both, alone)


def test_an_effect_whose_part_parameters_take_only_beyond_their_spread_is_not_idle(
    pulled_case: Case, fitted: tuple[FittedHypothesis, ...]
) -> None:
    # Truth by hand: without the second effect a parameter stands nine standard deviations from its file, six beyond what is free: 18 nats.
    both, alone, _, plain = fitted
    theta = alone.fit.hypothesis.theta.copy()
    theta[0] = 9.0
    bent = replace(alone, fit=replace(alone.fit, hypothesis=replace(alone.fit.hypothesis, theta=theta)))
    # Of 40 nats each effect must do 4: where the friction alone predicts 13 nats better than both the force does 5, at 15 it does 3.
    for worse, kept in ((13.0, (both, bent)), (15.0, (bent,))):
        explanations = Explanations((both, bent), plain, pulled_case.library, 5.0)
        assert without_idle(explanations, {(both, bent): [[Said(-worse, SURE, 40.0, 100)]]})[0].named == kept


def test_an_effect_must_do_its_part_beside_any_that_it_stands_with(
    pulled_case: Case, fitted: tuple[FittedHypothesis, ...]
) -> None:
    # Truth by hand: of 40 nats friction does 1 beside the force, whichever of the two is likelier by itself: it is idle; with 10 it is not.
    both, rubbing, pulled, plain = fitted
    rubbing, pulled = replace(rubbing, evidence=60.0), replace(pulled, evidence=50.0)
    explanations = Explanations((both, rubbing, pulled), plain, pulled_case.library, 5.0)
    further = {(both, rubbing): [[Said(35.0, SURE, 40.0, 100)]]}
    found, (rule,) = without_idle(explanations, {**further, (both, pulled): [[Said(1.0, SURE, 40.0, 100)]]})
    assert found.named == (rubbing, pulled)
    assert (rule.outcome, rule.value, rule.limit) == ("arm.coulomb is left out", 1.0, pytest.approx(4.0))
    shares = {**further, (both, pulled): [[Said(10.0, SURE, 40.0, 100)]]}
    assert without_idle(explanations, shares)[0].named == (both, rubbing, pulled)


def test_what_an_idle_effect_gained_it_gains_beside_the_twins_too(
    pulled_case: Case, fitted: tuple[FittedHypothesis, ...]
) -> None:
    # Truth by hand: an idle force brings a lag from 60 to 90 nats: so it would its twin of 50, to 80, and what is 85 already to no more
    # than those 90; what is no twin stays as it is.
    _, rubbing, _, plain = fitted
    both, lag, twin, likely, other = (
        replace(rubbing, effects=effects, evidence=evidence)
        for effects, evidence in (
            (("theta_sensor.lag", "arm.offset_force"), 90.0),
            (("theta_sensor.lag",), 60.0),
            (("input.lag",), 50.0),
            (("theta_sensor.delay",), 85.0),
            (("arm.coulomb",), 50.0),
        )
    )
    explanations = Explanations((both, lag, twin, likely, other), plain, pulled_case.library, 5.0)
    found, _ = without_idle(explanations, {(both, lag): [[Said(1.0, SURE, 40.0, 100)]]})
    assert found.named == (lag, twin, likely, other)
    assert [found.evidence_beside(entry) for entry in found.named] == [90.0, 80.0, 90.0, 50.0]


def test_what_a_large_effect_does_to_one_output_says_nothing_of_another(
    pulled_case: Case, fitted: tuple[FittedHypothesis, ...]
) -> None:
    # Truth by hand: 400 nats of one output are the first effect's alone; of the 30 of the other the second does 12, which is plain to see.
    both, alone, _, plain = fitted
    explanations = Explanations((both, alone), plain, pulled_case.library, 5.0)
    large = Said(0.5, 1.0, 400.0, 100)
    assert without_idle(explanations, {(both, alone): [[large, Said(12.0, 3.0, 30.0, 100)]]})[0].named == (both, alone)
    assert without_idle(explanations, {(both, alone): [[large, Said(2.0, 0.5, 30.0, 100)]]})[0].named == (alone,)


@pytest.mark.parametrize(
    ("said", "kept"),
    [
        ([(33.0, 11.0, 40.0, 100)], True),
        ([(39.0, 24.0, 40.0, 100)], False),
        ([(39.0, 24.0, 40.0, 100), (6.0, 2.5, 8.0, 50)], True),
        ([(33.0, 11.0, 40.0, 100), (2.0, 3.0, 3.0, 50)], False),
        ([(33.0, 11.0, 40.0, 100), (2.0, 9.0, 3.0, 50)], True),
        ([(33.0, 11.0, 40.0, 100), (0.0, 0.1, 0.0, 50)], False),
        ([(39.0, 24.0, 40.0, 100), (2.0, 9.0, 3.0, 50)], False),
    ],
    ids=[
        "sure, where nothing is held out",
        "unsure there",
        "the logs held out are sure",
        "they are sure that it does less than the 16.5 nats which it should",
        "they cannot tell: between 16 nats worse and 20 better",
        "it does nothing in them",
        "neither can tell",
    ],
)
def test_an_effect_must_surely_predict_better_in_logs_that_were_not_fitted_where_these_can_tell(
    pulled_case: Case,
    fitted: tuple[FittedHypothesis, ...],
    said: list[tuple[float, float, float, int]],
    kept: bool,
) -> None:
    # Truth by hand: twice its standard error is sure.
    both, alone, _, plain = fitted
    explanations = Explanations((both, alone), plain, pulled_case.library, 5.0)
    found, rules = without_idle(explanations, {(both, alone): [[Said(*part)] for part in said]})
    assert (found.named == (both, alone)) is kept
    assert len(rules) == (not kept)


def test_what_logs_held_out_refute_does_not_stand_beside_what_they_bear_out() -> None:
    # Truth: an arm that rubs by 0.4 mN m in all logs, and a pull of 0.3 mN m in those that were fitted alone.
    pull = {"arm.offset_force": {"offset": 3e-4}}
    case, other = arm_case(arm_log({**RUB, **pull}, seed=61)), arm_case(arm_log(RUB, seed=62))
    both, plain = settled(case, {**RUB, **pull}), settled(case, {})
    rubbing = both.fit.hypothesis.with_effects({"arm.coulomb": both.fit.hypothesis.effects["arm.coulomb"]})
    alone = FittedHypothesis(("arm.coulomb",), replace(both.fit, hypothesis=rubbing), 100.0)
    explanations, logs = Explanations((both, alone), plain, case.library, 5.0), FittedLogs(case)
    holdout = holdout_of(other, ["hold"], [None], case, plain)
    assert without_idle(explanations, shares_of(explanations, explanations.named, logs, None))[0].named == (both, alone)
    assert without_idle(explanations, shares_of(explanations, explanations.named, logs, holdout))[0].named == (alone,)


def test_a_grid_that_readings_show_makes_no_other_effect_a_small_part() -> None:
    # Truth: an arm that rubs, read in steps of 20 mrad where 1 mrad is stated. The grid alone is worth ln 20 = 3 nats a reading and more,
    # as a filter that knows it is not led astray, of which friction, that does all else of what is predicted better, would be a small part.
    coarse = {"theta_sensor.quantization": {"q": 20e-3}}
    case = arm_case(arm_log({**RUB, **coarse}, seed=63))
    both, read, plain = (settled(case, effects) for effects in ({**RUB, **coarse}, coarse, {}))
    explanations, logs = Explanations((both, read), plain, case.library, 5.0), FittedLogs(case)
    ((said,),) = (parts[0] for parts in shares_of(explanations, explanations.named, logs, None).values())
    assert logs.gain(both.fit.hypothesis, plain.fit.hypothesis) * logs.readings > 2.0 * said.whole
    assert said.nats == pytest.approx(said.whole, rel=1e-9)


def test_a_hold_out_is_silent_of_what_happened_in_other_logs() -> None:
    # Truth: an arm that rubs in all logs, and was pushed once in those that were fitted.
    push = {"arm.disturbance": {"torque": 2e-3, "t_0": 4.0, "duration": 1.5}}
    case, other = arm_case(arm_log({**RUB, **push}, seed=61)), arm_case(arm_log(RUB, seed=62))
    both, alone, plain = (settled(case, effects) for effects in ({**RUB, **push}, RUB, {}))
    explanations, logs = Explanations((both, alone), plain, case.library, 5.0), FittedLogs(case)
    shares = shares_of(explanations, explanations.named, logs, holdout_of(other, ["hold"], [None], case, plain))
    assert [len(said) for said in shares.values()] == [1]


def test_what_an_idle_effect_explains_row_by_row_does_not_speak_against_what_predicts(
    pulled_case: Case, fitted: tuple[FittedHypothesis, ...]
) -> None:
    # Truth by hand: the force alone predicts as well as both. Friction predicts nothing, but explains rows by 640 nats, alone or beside.
    *_, plain = fitted
    at = plain.evidence
    both, rubbing, pulled = (
        replace(entry, evidence=at + nats) for entry, nats in zip(fitted, (700.0, 640.0, 50.0), strict=False)
    )
    explanations = Explanations((both, rubbing, pulled), plain, pulled_case.library, 5.0)
    shares = {(both, rubbing): [[Said(40.0, SURE, 40.0, 100)]], (both, pulled): [[Said(1.0, SURE, 40.0, 100)]]}
    found, _ = without_idle(explanations, shares)
    assert [found.evidence_beside(entry) - at for entry in (rubbing, pulled)] == [640.0, 700.0]
    weighed = weigh(found, {both: 40.0, rubbing: 0.0, pulled: 39.0})
    assert weighed.fitted[0] is pulled
    assert weighed.ahead_nats == pytest.approx(39.0, abs=0.5)
