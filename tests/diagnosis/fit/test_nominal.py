"""The plant alone: its fit from where a name left the plant's numbers."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.gauss_newton import LITTLE_NATS, fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import best_plain_fit, plain_beside, plain_from, with_memory_from
from diagnosis.hypothesis.case import Case
from diagnosis.screening import detected
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

RUB = {"arm.coulomb": {"b": 1e-5}}


@pytest.fixture(scope="module")
def case() -> Case:
    """An arm as its file states it, without any effect."""
    return arm_case(arm_log(seed=81))


def named(case: Case, plain: Fit) -> Fit:
    found = fit(case, plain.hypothesis.with_effects(RUB))
    assert found is not None
    return found


def test_beside_a_name_that_is_none_the_plant_is_what_it_is_alone(case: Case) -> None:
    plain = nominal_fit(case)
    again = plain_beside(case, named(case, plain), plain)
    assert again is not None
    assert not again.hypothesis.effects
    assert again.log_posterior == pytest.approx(plain.log_posterior, abs=2.0 * LITTLE_NATS)
    assert plain_beside(case, plain, plain) is None


def test_from_another_hill_the_plant_comes_back(case: Case) -> None:
    """Truth: parameters as stated. A fit two deviations off under a thousand times the noise is not where the logs say."""
    plain = nominal_fit(case)
    hypothesis = plain.hypothesis
    far = replace(hypothesis, theta=hypothesis.theta + 2.0, process_noise=hypothesis.process_noise + 3.0)
    lost = fit(case, far, rounds=0)
    assert lost is not None
    assert lost.log_posterior < plain.log_posterior - 1000.0
    again = plain_beside(case, replace(named(case, plain), hypothesis=far.with_effects(RUB)), plain)
    assert again is not None
    assert again.log_posterior == pytest.approx(plain.log_posterior, abs=2.0 * LITTLE_NATS)
    assert np.all(np.abs(again.hypothesis.theta) < 3.0)


def test_another_reading_of_the_same_logs_ends_no_worse_than_the_first() -> None:
    """Truth: a torque that comes and goes. From the fit with it, whose white noise it has left little of, the plain fit and the one with
    noise with a memory are no worse than those that a search from nothing ends at."""
    gusty = arm_case(arm_log({"arm.gust": {"sigma": 3e-4, "T": 0.5}}, seed=82))
    plain, noisy = best_plain_fit(gusty), nominal_fit(gusty)
    assert noisy.log_posterior > plain.log_posterior + 10.0
    again = plain_from(gusty, noisy.hypothesis)
    assert not again.hypothesis.effects
    assert again.log_posterior == pytest.approx(plain.log_posterior, abs=2.0 * LITTLE_NATS)
    found = with_memory_from(gusty, again, noisy.hypothesis)
    assert found.hypothesis.effects.keys() == noisy.hypothesis.effects.keys()
    assert found.log_posterior > noisy.log_posterior - 2.0 * LITTLE_NATS


def test_no_gap_asks_for_no_second_fit(case: Case) -> None:
    seen = detected(case, None)
    assert seen.detection.p > 1e-3
    assert not [rule for rule in seen.decisions if rule.rule == "plain_again"]
