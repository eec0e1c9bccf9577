"""Whether there is a gap: what forms show is enough, and what they leave open is asked of effects."""

from collections.abc import Sequence

import pytest

from diagnosis import decisions
from diagnosis.detect.detection import Detection, detect
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.starts import ScoreTest
from records.log import RunLog
from tests.diagnosis.arm import LONG_S, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit


def detected(log: RunLog, tests: Sequence[ScoreTest]) -> tuple[Detection, bool]:
    """What is seen, and whether effects were asked for."""
    case = arm_case(log)
    found, asked = detect(case, linearised(case, nominal_fit(case)), lambda: tests)
    return found, asked is not None


def test_effects_are_asked_only_where_forms_leave_a_gap_open() -> None:
    # Truth: dry friction of twice its reference size, which forms show by far, and none.
    rubbed, asked = detected(arm_log({"arm.coulomb": {"b": 4.8e-5}}, seed=3), ())
    assert rubbed.p < decisions.ALARM
    assert rubbed.largest > decisions.PLAIN_TO_SEE
    assert not asked
    assert detected(arm_log(seed=3, seconds=LONG_S), ())[1]


@pytest.mark.parametrize(("gain", "is_gap"), [(2.0, False), (60.0, True)])
def test_what_an_effect_on_a_signals_way_gains_is_a_gap_where_forms_show_none(gain: float, is_gap: bool) -> None:
    # Truth: by chance the best of fifty effects gains 5 nats, and none 60.
    test = ScoreTest("input.delay", {"tau": 0.05}, 0.0, gain, 0.0, 0.0)
    found, _ = detected(arm_log(seed=3, seconds=LONG_S), [test])
    assert (found.p <= decisions.ALARM) is is_gap
