"""A log's clock may have been running long before: what scores find does not hang on where it began."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.detect.detection import FormScores, form_scores
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.score_tests import ScoreTest, score_effects
from diagnosis.explain.improved import improved_plant
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from records.log import RunLog
from sim.bind import bind
from tests.diagnosis.arm import PERIOD_S, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

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
    assert max(in_time[0].values()) > 20.0
    assert in_time[1] == pytest.approx(in_time[0], abs=5.0)


@pytest.mark.parametrize("began_s", [BEGAN_S, 1.7e9])
def test_the_plant_that_is_written_warms_up_by_the_clock_of_its_logs(began_s: float) -> None:
    # Truth: where the logs begin a simulation by their clock must begin to warm, be it a calendar's; WARM states another run's. Exact.
    case = arm_case(replace(arm_log(WARM, seconds=2.0), t_s=began_s + PERIOD_S * np.arange(200)))
    found = fit(case, nominal_hypothesis(case, -2.0).with_effects(WARM), rounds=0)
    assert found is not None
    written = bind(improved_plant(case, as_fitted(case, found))).effects["rotor.warmup"]
    assert written["t_0"].values == (began_s,)
