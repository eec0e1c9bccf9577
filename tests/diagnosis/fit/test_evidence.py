"""What a shape costs, and what is known of numbers, by hand."""

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.fit.evidence import log_evidence
from diagnosis.fit.free_numbers import Free
from diagnosis.fit.linear_problem import Fit, tempered
from diagnosis.hypothesis.hypothesis import Hypothesis
from sim.added_effects import library
from sim.bind import BoundPlant
from tests.diagnosis.arm import arm, arm_case, arm_log


@pytest.mark.parametrize("told", [0.0, 9.0, 9.99])
def test_a_shape_costs_the_same_whatever_the_logs_tell_of_it(plant: BoundPlant, told: float) -> None:
    # A friction of information 100 whose two shapes have 10 each, of which they share `told`: alike where each makes up for the other.
    effect = library(plant)["azimuth.stribeck"]
    size, *shapes = (effect.parameter[name] for name in ("b_s", "v_s", "e"))
    hypothesis = Hypothesis(np.zeros(0), {effect.name: {"b_s": 1e-3, "v_s": 0.1, "e": 1.0}}, np.zeros(2))
    alone = Fit(hypothesis, 50.0, 40.0, (Free(effect.name, size, 1e-3),), np.array([[100.0]]), np.zeros(1))
    information = np.array([[100.0, 0.0, 0.0], [0.0, 10.0, told], [0.0, told, 10.0]])
    free = (*alone.free, *(Free(effect.name, shape, 0.1) for shape in shapes))
    shaped = Fit(hypothesis, 50.0, 40.0, free, information, np.zeros(3))
    assert log_evidence(shaped, {effect.name: effect}) == pytest.approx(
        log_evidence(alone, {effect.name: effect}) - 2.0 * decisions.SHAPE_COST
    )


def test_what_is_known_is_of_the_likelihoods_root_and_of_the_whole_prior() -> None:
    # By hand: a parameter of spread 1 with 8 beyond that from the logs, a friction with 100 and 1 / SIZE_SD^2; their fourth root.
    case = arm_case(arm_log(seconds=2.0))
    count = len(case.free)
    size = Free("arm.coulomb", library(arm())["arm.coulomb"].parameter["b"], 1e-3)
    hypothesis = Hypothesis(np.zeros(count), {"arm.coulomb": {"b": 1e-3}}, np.zeros(1))
    prior = np.append(np.ones(count), decisions.SIZE_SD**-2.0)
    told = np.append(np.full(count, 8.0), 100.0)
    fitted = Fit(hypothesis, 50.0, 40.0, (size,), np.diag(told + prior), np.zeros(count + 1))
    root = tempered(case, fitted, 4.0)
    assert np.diag(root.information) == pytest.approx(told / 4.0 + prior)
    assert (root.hypothesis, root.log_posterior, root.tempering) == (hypothesis, 40.0, 4.0)
    assert tempered(case, fitted, 1.0).information == pytest.approx(fitted.information)
