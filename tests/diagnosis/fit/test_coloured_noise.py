"""Errors of readings that are alike from row to row: noise of every hypothesis, and no gap."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from diagnosis import decisions
from diagnosis.diagnose import Material, diagnose
from diagnosis.fit.coloured_noise import coloured_noise_of, colours, size_of
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.nominal import with_memory
from diagnosis.hypothesis.hypothesis import noise_on, nominal_hypothesis
from diagnosis.library.reading_noise import ReadingNoise
from diagnosis.screening import beside_noise, scored
from records.log import RunLog
from sim.effect import Role
from tests.diagnosis.arm import LONG_S, PERIOD_S, arm, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

STEP_RAD = 1.150486e-3
SD_RAD, TIME_S = 2.0 * STEP_RAD, 0.06  # truth: two counts, forgotten in six rows


def misread(log: RunLog, seed: int) -> RunLog:
    """The log with an Ornstein-Uhlenbeck process on its readings, rounded to counts again."""
    keep = np.exp(-PERIOD_S / TIME_S)
    white = np.random.default_rng(seed).standard_normal(len(log.t_s)) * SD_RAD * np.sqrt(1.0 - keep**2)
    error = lfilter([1.0], [1.0, -keep], white)
    return replace(log, y=np.round((log.y + error[:, None]) / STEP_RAD) * STEP_RAD)


@pytest.fixture(scope="module")
def log() -> RunLog:
    return misread(arm_log(seed=74, seconds=LONG_S), 75)


def test_they_are_found_with_size_and_time(log: RunLog) -> None:
    # 2000 rows hold 330 times six rows: 4 % of the size, some 15 % of the time; the arm's own noise may stand for a part of both, so that
    # twice these are hardly less likely: 25 % and 50 %, and no more than two nats between what is found and the truth.
    case = arm_case(log)
    found = nominal_fit(case)
    noise = found.hypothesis.reading_noise["theta_rad"]
    assert noise.sd == pytest.approx(SD_RAD, rel=0.25)
    assert noise.time_s == pytest.approx(TIME_S, rel=0.5)
    true = replace(
        found.hypothesis, reading_noise={"theta_rad": ReadingNoise(SD_RAD, TIME_S)}, process_noise=np.array([-2.0])
    )
    assert likelihood_of(case, true) < found.log_likelihood + 2.0


def test_an_encoder_alone_has_none() -> None:
    assert nominal_fit(arm_case(arm_log(seed=74))).hypothesis.reading_noise == {}


@pytest.mark.soak
def test_a_torque_that_comes_and_goes_is_found_beside_them() -> None:
    # Truth: both; asked once more beside what was taken, nothing more is.
    case = arm_case(misread(arm_log({"arm.gust": {"sigma": 3e-4, "T": 0.5}}, seed=74, seconds=LONG_S), 75))
    found = nominal_fit(case)
    assert "theta_rad" in found.hypothesis.reading_noise
    assert "arm.gust" in found.hypothesis.effects
    assert with_memory(case, found) is found


def test_no_other_numbers_are_likelier(log: RunLog) -> None:
    case = arm_case(log)
    found = coloured_noise_of(case, nominal_fit(case).hypothesis)
    best, own = likelihood_of(case, found), found.reading_noise["theta_rad"]
    for by_size, by_time in ((1.3, 1.0), (1.0 / 1.3, 1.0), (1.0, 1.6), (1.0, 1.0 / 1.6)):
        moved = ReadingNoise(by_size * own.sd, by_time * own.time_s)
        assert likelihood_of(case, replace(found, reading_noise={"theta_rad": moved})) < best


def test_they_are_no_gap(log: RunLog) -> None:
    found = diagnose(arm(), Material([log], [], [], [None])).diagnosis
    assert found.verdict == "no gap"
    assert any(note.kind == "coloured_readings" for note in found.note_records)


def test_errors_that_follow_a_name_are_left_for_it_where_that_is_far_likelier() -> None:
    """Truth: a mode of the arm rings behind its jolts. Errors of readings that follow any slow motion hide it; without, the mode
    is some hundred nats likelier than they are."""
    case = arm_case(arm_log({"arm.flexible_mode": {"gain": 1.0, "omega_n": 35.0, "zeta": 0.07}}, seed=91, kick_V=0.5))
    plain = nominal_fit(case).hypothesis
    noisy = fit(case, replace(plain, reading_noise={"theta_rad": ReadingNoise(SD_RAD, TIME_S)}))
    assert noisy is not None
    seen = scored(case, None, noisy, ())
    after = beside_noise(replace(seen, detection=replace(seen.detection, p=1.0)))
    assert after.retuned.fit.hypothesis.reading_noise == {}
    assert after.detection.p < decisions.ALARM
    assert [(rule.rule, rule.of) for rule in after.decisions[-1:]] == [("over_noise", "arm.flexible_mode")]


@pytest.mark.parametrize("durations_s", [(4.0,), (4.0, 8.0)])
def test_a_torque_that_stays_for_longer_than_a_share_of_the_longest_log_is_no_noise(durations_s) -> None:
    # Truth: a torque that never goes, so that the likeliest correlation time is the longest that may be asked. Tolerance: rounding.
    pushes = [{"arm.disturbance": {"torque": sign * 1e-3, "t_0": 0.0, "duration": 100.0}} for sign in (1.0, -1.0)]
    logs = [arm_log(push, 31, seconds) for push, seconds in zip(pushes, durations_s, strict=False)]
    case = arm_case(*logs)
    gust = noise_on(case, 0)
    assert gust is not None
    size, time = gust.symbol(Role.STRENGTH), gust.symbol(Role.MEMORY)
    start = nominal_hypothesis(case, -2.0).with_effects({gust.name: {size: 1e-4, time: 0.5}})
    longest_s = max(log.t_s[-1] - log.t_s[0] for log in logs)
    found = coloured_noise_of(case, start).effects[gust.name]
    assert found[time] == pytest.approx(decisions.LONGEST_MEMORY_SHARE * longest_s)


@pytest.mark.parametrize("torques", [100.0, 1.0])
def test_a_torque_that_comes_and_goes_stays_one_that_a_plant_file_may_state(torques: float) -> None:
    # Truth: noise of a hundred usual torques, which no plant file may state, is as large as one may.
    case = arm_case(arm_log(seed=74))
    (push, *_) = colours(case)
    effect = noise_on(case, 0)
    assert effect is not None
    sigma = effect.parameter[effect.symbol(Role.STRENGTH)]
    usual = case.library.bound.model.places.axes["arm"].torque_size
    start = push.put(nominal_hypothesis(case, -2.0), (0.1 * usual, 0.5))
    found = size_of(push).put(start, np.log10(torques * usual))
    assert push.of(found) == (min(torques * usual, sigma.upper), 0.5)
