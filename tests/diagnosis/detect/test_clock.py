"""A log's clock may have been running long before: what scores find does not hang on where it began."""

from dataclasses import replace

import pytest

from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import ScoreTest, score_effects
from diagnosis.fit.nominal import nominal_fit
from records.log import RunLog
from tests.diagnosis.arm import arm_case, arm_log

BEGAN_S = 465.645
WARM = {"rotor.warmup": {"a": 0.25, "T": 4.0, "t_0": 0.0}}


def scores(log: RunLog) -> dict[str, ScoreTest]:
    case = arm_case(log)
    return {
        entry.effect: entry
        for entry in score_effects(case, linearised(case, nominal_fit(case)), case.library.candidates)
    }


def test_a_clock_that_began_earlier_changes_no_score() -> None:
    # Truth: the same run by another clock. Rounded otherwise an axis comes to rest a row earlier, which moves a likelihood by some nats: 5.
    log = arm_log(WARM)
    one, other = scores(log), scores(replace(log, t_s=log.t_s + BEGAN_S))
    assert other["rotor.warmup"].values["t_0"] == pytest.approx(BEGAN_S)
    assert one["rotor.warmup"].gain > 30.0
    shown = [name for name, entry in one.items() if entry.gain > 0.0]
    assert [other[name].gain for name in shown] == pytest.approx([one[name].gain for name in shown], abs=5.0)
