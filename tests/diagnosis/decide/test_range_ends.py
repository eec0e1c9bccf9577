"""A sensor whose range ends shows in what follows a stand; a rest, a friction that holds and a stop do not."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.decide.range_ends import range_ends
from records.log import RunLog
from tests.diagnosis.arm import arm, arm_log
from tests.diagnosis.conftest import RUB


def ends(log: RunLog) -> list[str]:
    return [str(end.note.said) for end in range_ends(arm(), [log], [None], ["log"])]


def cut_off(log: RunLog, share: float) -> tuple[RunLog, float]:
    """The log as a sensor has it that reads up to a share of the output's range, and the last reading that it gives."""
    y = log.y[:, 0]
    level = y[np.argmin(np.abs(y - np.min(y) - share * np.ptp(y)))]
    return replace(log, y=np.minimum(log.y, level)), float(level)


@pytest.mark.parametrize("share", [0.6, 0.8])
def test_a_sensor_that_ends_within_the_way_is_told_by_what_follows(share: float) -> None:
    log, level = cut_off(arm_log(seed=7), share)
    (said,) = ends(log)
    assert f"theta_rad never exceeds {level:.5g} rad" in said


@pytest.mark.parametrize("effects", [None, RUB, {"theta_sensor.quantization": {"q": 0.0046}}])
def test_an_arm_that_rests_or_sticks_at_its_extreme_reads_it(effects: dict[str, dict[str, float]] | None) -> None:
    """Truth: the arm as stated, one whose dry friction holds it, and one whose encoder has steps of four counts."""
    assert ends(arm_log(effects, seed=7)) == []
