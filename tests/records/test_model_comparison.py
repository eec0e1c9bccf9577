"""The law from evidence to probabilities: its equations by hand."""

from dataclasses import replace

import numpy as np
import pytest

from records.model_comparison import Candidate, ComparisonLaw, ModelComparison, features, likeliest_of

LAW = ComparisonLaw(
    size=np.log(2.0),
    power=0.5,
    further=2.0,
    ahead=0.5,
    intercept=1.0,
    left=-1.0,
    curve=2.0,
    favour=2.0,
    partly_single=0.1,
    partly_several=0.8,
)
ONE, TWO = Candidate("a.one", 90.0, 0.0), Candidate("a.one + a.two", 99.0, -1.0, 4.0)
TOLD = ModelComparison((ONE, TWO), 99.0, 99.0, 9.0, 0.25)


def test_evidence_counts_by_a_scale_that_grows_with_what_forms_explain() -> None:
    assert LAW.scale_nats(99.0) == pytest.approx(20.0)
    assert LAW.scale_nats(0.0) == pytest.approx(2.0)


def test_shares_are_a_softmax_of_evidence_prior_further_effects_and_what_is_foreseen() -> None:
    # Truth by hand: 90 / 20 = 4.5 against 99 / 20 - 1 - 2 + 0.5 x 4 = 3.95; then parameters with 60 / 20 - 0.5 = 2.5 beside them.
    expected = np.exp([4.5, 3.95, -np.inf])
    assert LAW.shares(TOLD) == pytest.approx(expected / expected.sum())
    beside = np.exp([4.5, 3.95, 3.0 - 0.5])
    told = replace(TOLD, parameters_nats=60.0, parameters_ahead_nats=-1.0)
    assert LAW.shares(told) == pytest.approx(beside / beside.sum())


def test_whether_anything_explains_is_a_logistic_law_of_what_is_left() -> None:
    # Truth by hand: the first gains 90 of 99 nats, and 9 + 9 are left beside it.
    z = 1.0 - np.log(1.0 + 18.0 / 5.0) + 2.0 * 0.25
    assert LAW.explained(TOLD) == pytest.approx(1.0 / (1.0 + np.exp(-z)))
    joint = replace(TOLD, candidates=(replace(ONE, evidence_nats=0.0), TWO))
    z = 1.0 - np.log(1.0 + 9.0 / 5.0) + 2.0 * 0.25
    assert LAW.explained(joint) == pytest.approx(1.0 / (1.0 + np.exp(-z)))
    assert features(TOLD, np.array([0.6, 0.4, 0.0])) == pytest.approx((np.log(1.0 + 18.0 / 5.0), 0.25))
    assert features(replace(TOLD, favour=None), np.array([0.4, 0.6, 0.0]))[1:] == (0.0,)
    parameters = features(replace(TOLD, parameters_nats=60.0), np.array([0.2, 0.2, 0.6]))
    assert parameters == pytest.approx((np.log(1.0 + 48.0 / 5.0), 0.25))


@pytest.mark.parametrize("nats", [-500.0, 70.0, 90.0, 150.0, 1e5])
def test_a_free_curve_is_a_hypothesis_of_the_same_softmax(nats: float) -> None:
    # Truth by hand, scale 20: beside weights of 90 / 20 and 99 / 20 - 1 - 2, and of none for the plant alone, nothing foretold counting.
    rivals = np.log(np.exp(4.5) + np.exp(1.95) + 1.0)
    odds = np.exp(1.0 - np.log(1.0 + 18.0 / 5.0) + 2.0 * 0.25 - np.logaddexp(0.0, nats / 20.0 - 2.0 - rivals))
    assert LAW.explained(replace(TOLD, curve_nats=nats, curve_ahead_nats=1e9)) == pytest.approx(odds / (1.0 + odds))


@pytest.mark.parametrize("nats", [-30.0, 0.0, 4.0, 30.0])
def test_a_free_curve_counts_by_what_it_predicts_better_where_that_is_less(nats: float) -> None:
    # Truth by hand: the likeliest, a.one, predicts nothing better than the plant alone; 0.5 a nat, and log odds of -2 before the data.
    odds = np.exp(1.0 - np.log(1.0 + 18.0 / 5.0) + 2.0 * 0.25 - np.logaddexp(0.0, 0.5 * nats - 2.0))
    assert LAW.explained(replace(TOLD, curve_nats=1e5, curve_ahead_nats=nats)) == pytest.approx(odds / (1.0 + odds))


def test_where_nothing_was_tried_nothing_explains() -> None:
    nothing = ModelComparison((), 0.0, 0.0, 500.0)
    assert LAW.shares(nothing).tolist() == [0.0]
    assert LAW.explained(nothing) == 0.0
    assert (likeliest_of(nothing, LAW.shares(nothing)), LAW.partly(nothing, LAW.shares(nothing))) == (None, 0.0)


def test_parameters_alone_may_explain() -> None:
    alone = ModelComparison((), 60.0, 0.0, 5.0, None, 60.0)
    assert LAW.shares(alone).tolist() == [1.0]
    assert likeliest_of(alone, LAW.shares(alone)) is None
    assert LAW.explained(alone) == pytest.approx(1.0 / (1.0 + np.exp(-(1.0 - np.log(1.0 + 5.0 / 5.0)))))


def test_where_parameters_alone_are_likelier_no_name_is_the_likeliest() -> None:
    assert likeliest_of(TOLD, np.array([0.6, 0.4, 0.0])) is ONE
    assert likeliest_of(TOLD, np.array([0.3, 0.2, 0.5])) is None


def test_a_wrong_name_of_several_effects_is_oftener_right_in_part() -> None:
    assert LAW.partly(TOLD, np.array([0.6, 0.4, 0.0])) == pytest.approx(0.1)
    assert LAW.partly(TOLD, np.array([0.4, 0.6, 0.0])) == pytest.approx(0.8)


def test_of_what_a_free_curve_explains_no_name_is_a_part() -> None:
    # Truth by hand, scale 20: of the rest a curve of 180 nats leaves 1 / (1 + e^(9 - 2) / (e^4.5 + e^1.95 + 1)).
    left = 1.0 / (1.0 + np.exp(7.0) / (np.exp(4.5) + np.exp(1.95) + 1.0))
    assert LAW.partly(
        replace(TOLD, curve_nats=180.0, curve_ahead_nats=1e9), np.array([0.6, 0.4, 0.0])
    ) == pytest.approx(0.1 * left)
