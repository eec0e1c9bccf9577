"""A log's clock may have been running long before: what scores find does not hang on where it began."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.detect.detection import FormScores, form_scores
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.score_tests import ScoreTest, score_effects
from diagnosis.fit.nominal import nominal_fit
from records.log import RunLog
from tests.diagnosis.arm import arm_case, arm_log

BEGAN_S = 465.645
WARM = {"rotor.warmup": {"a": 0.25, "T": 4.0, "t_0": 0.0}}


def linear(log: RunLog) -> Linearisation:
    case = arm_case(log)
    return linearised(case, nominal_fit(case))


def scores(at: Linearisation) -> dict[str, ScoreTest]:
    return {entry.effect: entry for entry in score_effects(at.case, at, at.case.library.candidates)}


def timed(found: FormScores) -> dict[tuple[str, str], float]:
    """What the forms gain that grow with time."""
    gains = 0.5 * found.scores.score**2 / np.diag(found.scores.gram)
    each = zip(found.forms, gains.tolist(), strict=True)
    return {(form.class_text, form.shape): gain for form, gain in each if "(t / " in form.shape}


def test_a_clock_that_began_earlier_changes_no_score() -> None:
    # Truth: the same run by another clock. Rounded otherwise an axis comes to rest a row earlier, which moves a likelihood by some nats: 5.
    log = arm_log(WARM)
    here, there = linear(log), linear(replace(log, t_s=log.t_s + BEGAN_S))
    one, other = scores(here), scores(there)
    assert one["rotor.warmup"].gain > 30.0
    shown = [name for name, entry in one.items() if entry.gain > 0.0]
    assert [other[name].gain for name in shown] == pytest.approx([one[name].gain for name in shown], abs=5.0)
    in_time = [timed(form_scores(at)) for at in (here, there)]
    assert max(in_time[0].values()) > 30.0
    assert in_time[1] == pytest.approx(in_time[0], abs=5.0)
