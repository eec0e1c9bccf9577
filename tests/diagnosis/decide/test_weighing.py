"""Hypotheses become probabilities by the learned law: of what is explained each has a share, an unknown effect has the rest."""

from dataclasses import fields, replace

import numpy as np
import pytest

from diagnosis.decide.weighing import Explanations, alike, learned, weigh
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.search.free_curve import FittedCurve
from records.model_comparison import ComparisonLaw
from tests.diagnosis.arm import arm, plain_linearisation

LAW = ComparisonLaw(1.2, 0.28, 2.5, 1.0, 2.4, -0.5, 3.0, 3.0, 0.1, 0.8)


def fitted(evidence: float, **effects: dict[str, float]) -> FittedHypothesis:
    """The arm as stated with effects, of this evidence."""
    fit = plain_linearisation().fit
    named = {name.replace("__", "."): values for name, values in effects.items()}
    return FittedHypothesis(tuple(named), replace(fit, hypothesis=fit.hypothesis.with_effects(named)), evidence)


RUB = fitted(400.0, arm__coulomb={"b": 4e-4})
DRAG = fitted(390.0, arm__quadratic_drag={"c": 1e-6})
BOTH = fitted(402.0, arm__coulomb={"b": 4e-4}, arm__quadratic_drag={"c": 1e-6})


def explanations(*named: FittedHypothesis, left: float = 5.0, retune: float | None = None) -> Explanations:
    return Explanations(named, fitted(0.0), effect_library(arm()), left, retune=retune)


def test_all_probabilities_make_one_and_follow_the_comparison_that_is_kept() -> None:
    found = weigh(explanations(DRAG, RUB, BOTH, retune=350.0), {DRAG: 1.0, RUB: 4.0}, 0.4, LAW)
    assert found.comparison is not None
    assert sum((*found.probabilities, found.retune, found.unknown, found.partly)) == pytest.approx(1.0)
    assert found.fitted[0] is RUB
    shares, explained = LAW.shares(found.comparison), LAW.explained(found.comparison)
    assert found.probabilities[0] == pytest.approx(explained * shares[1])
    assert found.retune == pytest.approx(explained * shares[3])
    assert found.partly == pytest.approx(0.1 * (1.0 - explained))
    assert found.scale == LAW.scale_nats(402.0)
    assert [one.ahead_nats for one in found.comparison.candidates] == [
        1.0,
        4.0,
        1.0,
    ]  # what was not asked, as the least


def test_what_the_hold_out_refutes_is_less_likely_and_an_unknown_effect_likelier() -> None:
    for_it, against = (weigh(explanations(RUB), {}, favour, LAW) for favour in (0.9, -0.9))
    assert for_it.probabilities[0] > 0.9 > 0.4 > against.probabilities[0]
    assert against.nameless
    assert not for_it.nameless


def test_what_forms_leave_makes_an_unknown_effect_likelier() -> None:
    little, much = (weigh(explanations(RUB, left=left), {}, None, LAW).unknown for left in (3.0, 3000.0))
    assert much > little + 0.3


@pytest.mark.parametrize(("gained", "nameless"), [(100.0, False), (400.0, False), (1000.0, True)])
def test_what_a_free_curve_explains_better_has_no_name(gained: float, nameless: bool) -> None:
    named = explanations(RUB)
    plain = named.nominal
    nothing = np.zeros(0)
    curve = FittedCurve(None, nothing, nothing, plain_linearisation().case, plain.fit, gained, 1e9)  # type: ignore[arg-type]
    found = weigh(replace(named, curve=curve), {}, None, LAW)
    assert found.comparison is not None
    assert found.comparison.curve_nats == gained
    assert found.nameless is nameless
    told = {rule.rule: (rule.value, rule.limit, rule.outcome) for rule in found.decisions if "curve" in rule.rule}
    assert told["free_curve"] == (gained, 400.0, "explains more" if gained > 400.0 else "explains less")
    assert told["free_curve_foresees"] == (1e9, 0.0, "predicts better")


def test_what_earns_no_name_counts_beside_a_free_curve_as_beside_the_likeliest() -> None:
    """Truth: friction has 400 nats alone and 2400 beside what is dropped; a curve of 700 alone has 2700 beside the same, more by 300."""
    named = explanations(RUB)
    nothing = np.zeros(0)
    curve = FittedCurve(None, nothing, nothing, plain_linearisation().case, named.nominal.fit, 700.0, 1e9)  # type: ignore[arg-type]
    found = weigh(replace(named, curve=curve, beside={RUB: 2400.0}), {}, None, LAW)
    assert found.comparison is not None
    assert (found.comparison.curve_nats, found.comparison.gain_nats) == (2700.0, 2400.0)
    assert found.nameless


def test_parameters_that_leave_their_spread_are_paid_in_full() -> None:
    """Truth: five deviations are two beyond the three that are free, half of 2^2 nats, however little of its evidence counts."""
    theta = RUB.fit.hypothesis.theta.copy()
    theta[0] = 5.0
    far = replace(RUB, fit=replace(RUB.fit, hypothesis=replace(RUB.fit.hypothesis, theta=theta)))
    told = [weigh(explanations(entry), {}, None, LAW).comparison for entry in (RUB, far)]
    (near_prior,), (far_prior,) = ([one.prior_nats for one in found.candidates] for found in told if found is not None)
    assert near_prior - far_prior == pytest.approx(2.0)


def test_parameters_alone_are_told_as_that_and_what_they_do_not_explain_is_unknown() -> None:
    explained, not_there = (
        weigh(explanations(left=5.0, retune=160.0), {}, None, LAW),
        weigh(explanations(left=5.0), {}, None, LAW),
    )
    assert explained.retune > 0.7
    assert explained.fitted == not_there.fitted == ()
    assert (not_there.unknown, not_there.retune) == (1.0, 0.0)


def test_names_that_the_logs_hardly_tell_apart_are_alike() -> None:
    found = weigh(explanations(RUB, DRAG, BOTH), {}, None, LAW)
    assert alike(found, RUB) == [DRAG]
    assert alike(weigh(explanations(RUB, replace(DRAG, evidence=100.0)), {}, None, LAW), RUB) == []


def test_the_learned_law_says_what_such_a_law_must() -> None:
    """Truth: more left is likelier unknown, what predicts better is likelier, further effects cost, as does a free curve, a part of several
    is oftener right; ten numbers."""
    law = learned()
    assert law.left <= 0.0 <= law.favour
    assert law.curve > 0.0
    assert law.further > 0.0
    assert law.ahead > 0.0
    assert 0.0 < law.partly_single < law.partly_several < 1.0
    assert len(fields(law)) <= 10


def test_a_re_tune_that_gains_nothing_beside_forms_that_gain_thousands_of_nats_is_unknown_by_the_learned_law() -> None:
    assert weigh(explanations(left=4000.0, retune=0.0), {}).unknown > 0.8
    assert weigh(explanations(left=5.0, retune=4000.0), {}).unknown < 0.5
