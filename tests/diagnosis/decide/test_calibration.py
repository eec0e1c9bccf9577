"""Weights become probabilities by the learned law, all else keeps its proportions."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.calibration import FEATURES, Law, calibrated, features_of, learned
from diagnosis.decide.weighing import Weighed
from diagnosis.fit.evidence import FittedHypothesis
from tests.diagnosis.arm import plain_linearisation


def weighed(first: float, second: float, unknown: float) -> Weighed:
    fit = plain_linearisation().fit
    names = tuple(FittedHypothesis((name,), fit, 0.0) for name in ("a.one", "a.two"))
    return Weighed(names, (first, second), unknown, 1.0 - first - second - unknown, 10.0)


def test_what_explains_shares_the_laws_probability_a_part_its_own_and_the_unknown_has_the_rest() -> None:
    law = Law(-0.5, (1.0, 2.0, 0.0, -0.3), (0.25, 0.8))
    found, rules = calibrated(weighed(0.5, 0.2, 0.2), 0.25, law)  # other parameters have 0.1
    truth = 1.0 / (1.0 + np.exp(0.5 - np.log(0.8 / 0.2) - 0.5))
    assert (*found.probabilities, found.retune) == pytest.approx((truth * 5 / 8, truth * 2 / 8, truth * 1 / 8))
    assert found.partly == pytest.approx(0.25 * (1.0 - truth))
    assert found.unknown == pytest.approx(0.75 * (1.0 - truth))
    told = {rule.rule: rule.value for rule in rules}
    assert (told["calibration_favour"], told["calibration_silent"], told["calibration_further"]) == (0.25, 0.0, 0.0)
    assert told["calibration_share"] == pytest.approx(5.0 / 8.0)
    assert told["partly_true"] == pytest.approx(found.partly)


def test_of_several_effects_the_law_of_several_counts() -> None:
    law = Law(-0.5, (0.0, 0.0, 0.0, -1.0), (0.25, 0.8))
    pair = replace(weighed(0.7, 0.0, 0.3).fitted[0], effects=("a.one", "a.two"))
    found, _ = calibrated(Weighed((pair,), (0.7,), 0.3, 0.0, 10.0), 0.0, law)
    truth = 1.0 / (1.0 + np.exp(1.5))
    assert found.probabilities == pytest.approx((truth,))
    assert found.partly == pytest.approx(0.8 * (1.0 - truth))
    assert not found.nameless  # 0.83 that something of it is right


def test_surer_weights_than_the_law_was_told_of_count_no_more() -> None:
    assert features_of(weighed(1.0 - 1e-9, 0.0, 1e-9), None).sure == decisions.FARTHEST_LOGIT
    assert features_of(weighed(1e-9, 0.0, 1.0 - 1e-9), None).sure == -decisions.FARTHEST_LOGIT


def test_without_a_name_nothing_is_asked() -> None:
    nameless = Weighed((), (), 1.0, 0.0, 10.0)
    assert calibrated(nameless, 0.5) == (nameless, ())


def test_names_that_weigh_nothing_stay_so() -> None:
    nothing = weighed(0.0, 0.0, 1.0)
    assert calibrated(nothing, 0.5) == (nothing, ())


def test_the_learned_law_is_surer_of_what_weighs_more_what_a_hold_out_favours_and_what_names_less() -> None:
    law = learned()
    assert len(law.coefficients) == len(FEATURES)
    assert law.partly[0] < law.partly[1]

    def p(sure: float, favour: float) -> float:
        return law.probability(features_of(weighed(sure, 0.0, 1.0 - sure), favour))

    assert p(0.9, 0.5) > p(0.4, 0.5)
    assert p(0.7, 0.8) > p(0.7, -0.5)
    assert law.coefficients[FEATURES.index("further")] < 0.0
