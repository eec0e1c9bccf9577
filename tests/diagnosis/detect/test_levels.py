"""Sizes that are tried at full size: levels of a limit where the command is most of the time, others from the mildest on."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.detect.full_size import along
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.nominal import plain_fit
from sim.added_effects import library
from tests.diagnosis.arm import LONG_S, arm, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

LIMIT = {"input.saturation": {"limit": 1.9, "w": 0.05}}


def test_a_limit_is_seen_far_below_the_peaks_of_kicks() -> None:
    # Truth: 1.9 V at most of commands about 1.8 V, among which one in a hundred is a kick of nearly twice as much.
    case = arm_case(arm_log(LIMIT, seed=53, kick_V=1.8))
    sent = case.flights[0].filter_input.u[:, 0]
    assert np.max(sent) > 3.4
    (seen,) = score_effects(case, linearised(case, nominal_fit(case)), ["input.saturation"])
    assert seen.gain > 30.0
    assert seen.values["limit"] == pytest.approx(1.9, rel=0.15)


def test_a_sharp_limit_is_seen_that_peaks_alone_reach() -> None:
    # Truth: what one command in a hundred exceeds is cut off, by no rounded corner.
    limit_V = float(np.quantile(arm_log(seed=42, seconds=LONG_S).u, 0.99))
    case = arm_case(arm_log({"input.saturation": {"limit": limit_V, "w": 0.0}}, seed=42, seconds=LONG_S))
    (seen,) = score_effects(case, linearised(case, nominal_fit(case)), ["input.saturation"])
    assert seen.gain > 30.0
    assert seen.values["limit"] == pytest.approx(limit_V, rel=0.01)
    assert seen.values["w"] == 0.0


def test_steps_begin_at_all_that_promise_as_first_order_knows_no_hill() -> None:
    # Truth: steps of 0.11 V at their multiples, beside which steps of 0.108 V that lie elsewhere promise more.
    case = arm_case(arm_log({"input.quantization": {"q": 0.11}}, seed=61))
    (seen,) = score_effects(case, linearised(case, nominal_fit(case)), ["input.quantization"])
    assert min(abs(start.values["q"] / 0.11 - 1.0) for start in seen.starts) < 0.005
    assert len(seen.starts) <= decisions.NEXT


@pytest.mark.parametrize(
    ("name", "place"), [("theta_sensor.backlash", 0), ("input.backlash", 1), ("input.slew_limit", 0)]
)
def test_sizes_are_tried_from_the_mildest_on_until_they_lose(name: str, place: int) -> None:
    # Truth: one of the sizes that are tried: the mildest play of all, the second of three, and the slowest of eight rates, behind seven
    # limits that say next to nothing. It is worth to be taken in.
    effect = library(arm())[name]
    size = sorted(effect.size.starts)[place]
    case = arm_case(arm_log({name: {effect.size.symbol: size}}))
    (seen,) = score_effects(case, linearised(case, nominal_fit(case)), [name])
    assert seen.values[effect.size.symbol] == size
    assert seen.gain > decisions.TAKEN_IN


def test_of_a_play_that_is_not_there_none_gains() -> None:
    # Truth: none; the severest play that is asked of would lose thousands of nats, so that no try of it must be what is told.
    case = arm_case(arm_log({}))
    (seen,) = score_effects(case, linearised(case, nominal_fit(case)), ["theta_sensor.backlash"])
    assert seen.gain < 0.0
    assert seen.values["width"] < max(library(arm())["theta_sensor.backlash"].size.starts)


def test_play_is_tried_beyond_one_that_loses_and_a_delay_is_not() -> None:
    # Truth: none of either. Play has no first order: what is small says nothing of what is large. The likelihood by a delay is concave.
    case = arm_case(arm_log({}))
    linearisation = linearised(case, nominal_fit(case))
    for name, symbol, beyond in (("theta_sensor.backlash", "width", True), ("theta_sensor.delay", "tau", False)):
        effect = library(arm())[name]
        sizes = sorted(effect.size.starts)
        found = along(case, linearisation, effect, [{**effect.absent, symbol: size} for size in sizes])
        losing = [entry.gain < -decisions.chance_nats() for entry in found]
        assert losing.index(True) < len(losing) - 1 if beyond else losing.index(True) == len(losing) - 1


def test_a_limit_is_tried_beyond_one_that_cuts_noise_alone_and_loses() -> None:
    # Truth: the driver ramps at 2 V/s, and a command that is logged with 0.05 V of noise is cut in vain by limits that are milder. One of
    # 5.55 V/s loses, that of 2.59 V/s, the next of its starts, gains.
    log = arm_log({"input.slew_limit": {"r": 2.0}}, seconds=6.0)
    noisy = replace(log, u=log.u + 0.05 * np.random.default_rng(1).standard_normal(log.u.shape))
    case = arm_case(noisy)
    linearisation = linearised(case, plain_fit(case))
    start = linearisation.fit.hypothesis
    milder = likelihood_of(case, start.with_effects({"input.slew_limit": {"r": 5.55}}))
    assert milder < linearisation.fit.log_likelihood - decisions.chance_nats()
    (found,) = score_effects(case, linearisation, ["input.slew_limit"])
    assert found.values["r"] == pytest.approx(2.59)
    assert found.gain > decisions.chance_nats()
