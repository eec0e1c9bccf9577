"""A log's clock may have been running long before: what scores find does not hang on where it began."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.detect.form_scores import FormScores, form_scores
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import ScoreTest
from diagnosis.explain.improved import improved_plant
from diagnosis.fit.evidence import as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from records.log import RunLog
from sim.bind import bind
from tests.diagnosis.arm import PERIOD_S, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

BEGAN_S = 465.625
TICK_S = 2.0**-13  # of a clock: sums of its times with BEGAN_S are exact
WARM = {"rotor.warmup": {"a": 0.25, "T": 4.0, "t_0": 0.0}}


def linear(log: RunLog) -> Linearisation:
    case = arm_case(log)
    return linearised(case, nominal_fit(case))


def scores(at: Linearisation) -> dict[str, ScoreTest]:
    return {entry.effect: entry for entry in score_effects(at.case, at, at.case.library.candidates)}


def gained(found: FormScores) -> dict[tuple[str, str], float]:
    """What each form gains."""
    gains = 0.5 * found.scores.score**2 / np.diag(found.scores.gram)
    return {(form.class_text, form.shape): gain for form, gain in zip(found.forms, gains.tolist(), strict=True)}


def test_a_clock_that_began_earlier_changes_no_score() -> None:
    # Truth: the same run by another clock whose times are as far apart to the last bit, as by others rounded an axis comes to rest a row
    # earlier, which moves a likelihood by some nats: equal to a hundredth of one.
    log = arm_log(WARM)
    log = replace(log, t_s=TICK_S * np.round(log.t_s / TICK_S))
    here, there = linear(log), linear(replace(log, t_s=log.t_s + BEGAN_S))
    one, other = scores(here), scores(there)
    assert one["rotor.warmup"].gain > 30.0
    shown = [name for name, entry in one.items() if entry.gain > 0.0]
    assert [other[name].gain for name in shown] == pytest.approx([one[name].gain for name in shown], abs=0.01)
    forms = [gained(form_scores(at)) for at in (here, there)]
    assert max(gain for (_, shape), gain in forms[0].items() if "(t / " in shape) > 20.0
    assert forms[1] == pytest.approx(forms[0], abs=0.01)


@pytest.mark.parametrize("began_s", [BEGAN_S, 1.7e9])
def test_the_plant_that_is_written_warms_up_by_the_clock_of_its_logs(began_s: float) -> None:
    # Truth: where the logs begin a simulation by their clock must begin to warm, be it a calendar's; WARM states another run's. Exact.
    case = arm_case(replace(arm_log(WARM, seconds=2.0), t_s=began_s + PERIOD_S * np.arange(200)))
    found = fit(case, nominal_hypothesis(case, -2.0).with_effects(WARM), rounds=0)
    assert found is not None
    written = bind(improved_plant(case, as_fitted(case, found))).effects["rotor.warmup"]
    assert written["t_0"].values == (began_s,)
