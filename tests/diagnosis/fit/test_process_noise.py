"""The noise of a hypothesis: of each axis, and how long dry friction is in doubt at rest, where the likelihood is highest."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import Hypothesis, nominal_hypothesis
from diagnosis.hypothesis.initial_state import FIRST_REST_DOUBT
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from sim.columns import log_columns
from sim.simulate import Conditions, Noise, simulate
from tests.diagnosis.arm import arm_case, arm_log
from tests.plants import bound

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


def coil_case(noise: float) -> Case:
    """A coil under steps of duty, whose current is shaken by `noise`, in A per sqrt(s), and read as surely as its file states."""
    rig = bound("maglev_coil")
    t_s = 0.001 * np.arange(8000)
    u = np.random.default_rng(5).choice([0.2, 0.4, 0.8], len(t_s) // 200 + 1).repeat(200)[: len(t_s), None]
    run = simulate(rig, t_s, np.zeros(1), u, Conditions(noise=Noise(6, process_sd=np.array([noise])), keep="y"))
    y = np.asarray(run.y).reshape(len(t_s), -1) + np.random.default_rng(7).normal(0.0, 7e-3, (len(t_s), 1))
    return make_case(effect_library(rig), [RunLog(log_columns(rig.model), 0.001, "open", t_s, u, y)])


def test_a_measured_state_that_is_no_axis_has_noise_of_its_own() -> None:
    """Truth: 0.5 A per sqrt(s), to a tenth of a decade: the same rows tell how sure readings are."""
    case = coil_case(0.5)
    (state,) = case.measured_sizes
    found = with_process_noise(case, nominal_hypothesis(case, -1.5))
    assert found.state_noise[state] == pytest.approx(np.log10(0.5), abs=0.1)


def test_a_measured_state_that_follows_its_equation_has_hardly_any_noise() -> None:
    case = coil_case(0.0)
    (state,) = case.measured_sizes
    found = with_process_noise(case, nominal_hypothesis(case, -1.5))
    assert found.state_noise[state] < np.log10(0.5) - 1.0


def test_what_moves_as_an_axis_does_is_no_measured_state() -> None:
    assert arm_case(arm_log(seed=72)).measured_sizes == {}
