"""The noise of a hypothesis: of each axis, and how long dry friction is in doubt at rest, where the likelihood is highest."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.gauss_newton import likelihood_of
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.hypothesis.initial_state import FIRST_REST_DOUBT
from tests.diagnosis.arm import arm_case, arm_log

RUB = {"arm.coulomb": {"b": 4e-4}}  # 8 rad/s^2, which stops the arm within a row


@pytest.fixture(scope="module")
def rubbing() -> Case:
    return arm_case(arm_log(RUB, seed=71))


def supposing(case: Case, effects: dict[str, dict[str, float]]) -> Hypothesis:
    return Hypothesis(np.zeros(len(case.free)), effects, np.array([-2.0]))


def test_the_process_noise_is_that_of_the_rig() -> None:
    case = arm_case(arm_log(seed=72))  # which shakes it with 0.01 rad/s per sqrt(s)
    found = with_process_noise(case, supposing(case, {}))
    assert found.process_noise[0] == pytest.approx(-2.0, abs=0.3)
    assert found.rest_doubt == FIRST_REST_DOUBT  # an arm that does not rub


def test_friction_that_is_what_it_is_is_hardly_in_doubt(rubbing: Case) -> None:
    found = with_process_noise(rubbing, supposing(rubbing, RUB))
    assert found.rest_doubt < -4.0
    as_before = likelihood_of(rubbing, replace(found, rest_doubt=FIRST_REST_DOUBT))
    assert likelihood_of(rubbing, found) > as_before + 200.0


def test_true_friction_is_likelier_than_bristles_that_mimic_it(rubbing: Case) -> None:
    bristles = {"arm.presliding": {"b": 4e-4, "z_0": 1e-3}}
    true, other = (with_process_noise(rubbing, supposing(rubbing, effects)) for effects in (RUB, bristles))
    assert likelihood_of(rubbing, true) > likelihood_of(rubbing, other) + 50.0


def test_friction_of_the_wrong_size_is_in_doubt_or_shaken(rubbing: Case) -> None:
    found = with_process_noise(rubbing, supposing(rubbing, {"arm.coulomb": {"b": 2e-4}}))
    assert found.process_noise[0] > -1.0
