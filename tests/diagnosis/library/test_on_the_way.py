"""What effects make of inputs before a filter takes them, states that they bring, and what a reading is usually worth."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.filter.filter_input import filter_input_of
from diagnosis.hypothesis.usual import with_usual
from diagnosis.library.effect_library import effect_library
from diagnosis.library.filter_state import with_filter_state
from diagnosis.library.input_effects import commanded, lost_with, share_slopes
from tests.diagnosis.arm import arm, arm_case, arm_log, plain_linearisation


def test_a_lag_of_an_input_is_the_mean_of_its_exponential_over_each_step() -> None:
    # Truth: behind a lag of tau a step of 1 V has arrived by 1 - exp(-t / tau); its mean over [t, t + h] is
    # 1 - tau / h (exp(-t / tau) - exp(-(t + h) / tau)). Right to third order in h / tau.
    log = arm_log(seconds=2.0)
    u = np.where(log.t_s < 0.5, 0.0, 1.0)[:, None]
    given = filter_input_of(replace(log, u=u), arm().plant, ["theta_rad"])
    tau_s, h = 0.1, 0.01
    found = commanded(effect_library(arm()), given, {"input.lag": {"tau": tau_s}}).u[:, 0]
    since = given.t_s - 0.5
    mean = 1.0 - tau_s / h * (np.exp(-since / tau_s) - np.exp(-(since + h) / tau_s))
    np.testing.assert_allclose(found[since >= 0.0][:-1], mean[since >= 0.0][:-1], atol=1e-4)
    np.testing.assert_array_equal(found[since < -1e-9], 0.0)


def test_two_lags_of_an_input_are_the_mean_of_both_exponentials() -> None:
    # Truth: behind lags a and c in a row a step of 1 V has arrived by 1 - (a exp(-t / a) - c exp(-t / c)) / (a - c).
    log = arm_log(seconds=2.0)
    given = filter_input_of(replace(log, u=np.where(log.t_s < 0.5, 0.0, 1.0)[:, None]), arm().plant, ["theta_rad"])
    a, c, h = 0.07, 0.03, 0.01
    found = commanded(effect_library(arm()), given, {"input.lag": {"tau": 0.1, "b": 0.3}}).u[:, 0]
    since = given.t_s[:-1] - 0.5
    faded = [tau**2 / h * (np.exp(-since / tau) - np.exp(-(since + h) / tau)) for tau in (a, c)]
    mean = 1.0 - (faded[0] - faded[1]) / (a - c)
    np.testing.assert_allclose(found[:-1][since > -1e-9], mean[since > -1e-9], atol=1e-9)


def test_what_readings_say_of_a_lost_frame_changes_its_odds() -> None:
    # Truth: Bayes. Odds of 1 : 4 before and a likelihood ratio of e^2 give e^2 / (4 + e^2).
    assert lost_with(np.array([2.0]), 0.2)[0] == pytest.approx(np.exp(2.0) / (4.0 + np.exp(2.0)))
    given = replace(filter_input_of(arm_log(seconds=2.0), arm().plant, ["theta_rad"]), lost=np.full(200, 1e-9))
    slope, bend = share_slopes(given, 0.2)
    assert abs(slope) < 1e-6  # where readings say next to nothing, the share that was assumed fits
    assert bend == pytest.approx(-200.0 / (0.2 * 0.8))


def test_states_of_a_gust_and_of_a_sensors_lag_join_the_equations() -> None:
    # Truth: g' = -g / T pushes the arm; tau l' = y - l, and l is read.
    model, effects = arm().model, effect_library(arm()).effects
    gust = with_filter_state(model, effects["arm.gust"])
    assert [str(state) for state in gust.states][len(model.states) :] == ["arm_gust"]
    assert gust.states[-1] in gust.axes[0].torque.free_symbols
    late = with_filter_state(model, effects["theta_sensor.lag"])
    assert [str(state) for state in late.states][len(model.states) :] == ["theta_rad_read"]
    assert late.states[-1] in late.outputs["theta_rad"].free_symbols


def test_a_reading_is_usually_worth_its_likelihood_under_the_nominal_plant() -> None:
    # Truth: of whitened innovations near one, the sum is the filter's log likelihood but for readings that stand for several rows.
    linearisation = plain_linearisation()
    case = arm_case(linearisation.case.flights[0].log)
    usual = with_usual(case, linearisation.fit.hypothesis).flights[0].filter_input.usual
    run = linearisation.runs[0]
    known = np.isfinite(run.w[:, 0])
    assert usual[known, 0] == pytest.approx(-0.5 * (run.w[known, 0] ** 2 + np.log(run.s[known, 0])), rel=1e-6)
    assert (usual[~known, 0] == 0.0).all()
