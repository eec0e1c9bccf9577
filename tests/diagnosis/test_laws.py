"""Laws that hold whatever the rig: what does not change the question changes neither the verdict nor the first name, nor its
probability by more than a tenth."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import Material, diagnose
from diagnosis.result import Result
from records.log import RunLog
from tests.diagnosis.arm import arm, arm_log
from tests.soak import sampled

Logs = list[RunLog]
RIGS = {
    "rubs": {"arm.coulomb": {"b": 4e-4}},
    "lags": {"input.lag": {"tau": 0.08}},
    "as stated": {},
}


def rows(log: RunLog, chosen: slice) -> RunLog:
    """Some rows of a log, as a log of its own that begins at 0."""
    t_s = log.t_s[chosen]
    step = chosen.step or 1
    return replace(log, t_s=t_s - t_s[0], u=log.u[chosen], y=log.y[chosen], sample_period_s=step * log.sample_period_s)


def in_two(logs: Logs) -> Logs:
    """The first log given as two."""
    half = len(logs[0].t_s) // 2
    return [rows(logs[0], slice(0, half)), rows(logs[0], slice(half, None)), *logs[1:]]


def thinned(logs: Logs) -> Logs:
    """Every second row left out, at which no command changed: else commands would be lost with the rows."""
    return [rows(log, slice(None, None, 2)) for log in logs]


def noisier(logs: Logs) -> Logs:
    """A third of a step of noise added to the readings, which are rounded anew."""
    rng, (step,) = np.random.default_rng(4), arm().plant.sensors.values()
    return [
        replace(log, y=step * np.round((log.y + step / 3.0 * rng.standard_normal(log.y.shape)) / step)) for log in logs
    ]


def backwards(logs: Logs) -> Logs:
    """The logs in another order."""
    return logs[::-1]


LAWS: dict[str, Callable[[Logs], Logs]] = {
    "one log given as two": in_two,
    "every second row": thinned,
    "another order": backwards,
    "noise of a third of a step": noisier,
}


def answered(logs: Logs, holdout: Logs | None = None) -> Result:
    """What the diagnosis makes of logs of an arm."""
    held = holdout or []
    names = [f"log {number}" for number in range(len(logs))]
    masks = [None] * (len(logs) + len(held))
    return diagnose(arm(), Material(logs, held, [f"held {k}" for k in range(len(held))], masks, names=names))


@pytest.fixture(scope="module")
def plainly() -> Callable[[str], tuple[Logs, Result]]:
    """Logs of a rig and what is made of them, once for each rig."""
    kept: dict[str, tuple[Logs, Result]] = {}

    def asked(rig: str) -> tuple[Logs, Result]:
        if rig not in kept:
            logs = [arm_log(RIGS[rig], seed=seed, rows=2) for seed in (71, 72)]
            kept[rig] = logs, answered(logs)
        return kept[rig]

    return asked


def same(one: Result, other: Result) -> None:
    first, second = one.diagnosis, other.diagnosis
    assert first.verdict == second.verdict
    if first.effects:
        assert second.effects
        if second.effects[0].effect in first.effects[0].ambiguous_with:
            return  # which the first answer said that it is hardly told from
        assert first.effects[0].effect == second.effects[0].effect
        assert first.effects[0].probability == pytest.approx(second.effects[0].probability, abs=0.1)


@pytest.mark.parametrize(("rig", "law"), sampled([(rig, law) for rig in RIGS for law in LAWS], keep=[]))
def test_what_is_no_other_question_has_no_other_answer(
    plainly: Callable[[str], tuple[Logs, Result]], rig: str, law: str
) -> None:
    logs, before = plainly(rig)
    same(before, answered(LAWS[law](logs)))


@pytest.mark.parametrize("rig", sampled(RIGS, keep=[]))
def test_a_hold_out_of_the_same_rig_changes_no_verdict(plainly: Callable[[str], tuple[Logs, Result]], rig: str) -> None:
    logs, before = plainly(rig)
    after = answered(logs, [arm_log(RIGS[rig], seed=73, rows=2)])
    assert before.diagnosis.verdict == after.diagnosis.verdict
    assert [e.effect for e in before.diagnosis.effects[:1]] == [e.effect for e in after.diagnosis.effects[:1]]


@pytest.mark.soak
def test_a_hold_out_of_another_rig_makes_no_sure_gap_none() -> None:
    logs = [arm_log(RIGS["rubs"], seed=71, seconds=8.0)]
    before = answered(logs)
    assert before.diagnosis.false_alarm_probability < 1e-6
    after = answered(logs, [arm_log(seed=74, seconds=8.0)])  # which does not rub
    assert after.diagnosis.verdict == "gap"
    assert after.diagnosis.false_alarm_probability == before.diagnosis.false_alarm_probability
