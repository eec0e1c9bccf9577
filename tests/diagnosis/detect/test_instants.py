"""What happens at an instant happens in a log, or it is another value of what it changes."""

import pytest

from diagnosis.detect.instants import happened
from diagnosis.hypothesis.hypothesis import ELSEWHERE, nominal_hypothesis
from tests.diagnosis.arm import arm_case, arm_log

SECONDS = 8.0  # of which readings count from 0.8 s on


@pytest.mark.parametrize(
    ("effects", "told"),
    [
        ({"arm.weight_shift": {"Delta": 1e-3, "t_1": 0.5}}, False),
        ({"arm.weight_shift": {"Delta": 1e-3, "t_1": 3.0}}, True),
        ({"arm.weight_shift": {"Delta": 1e-3, "t_1": 9.0}}, False),
        ({"arm.disturbance": {"torque": 1e-3, "t_0": 0.2, "duration": 2.0}}, True),  # it ends, as readings show
        ({"arm.coulomb": {"b": 1e-4}}, True),
        ({}, True),
    ],
)
def test_what_stays_from_an_instant_on_must_happen_while_readings_count(
    effects: dict[str, dict[str, float]], told: bool
) -> None:
    case = arm_case(arm_log(seconds=SECONDS))
    assert happened(case, nominal_hypothesis(case, -1.5).with_effects(effects)) is told


def test_of_two_logs_one_in_which_it_happens_is_enough() -> None:
    case = arm_case(arm_log(seconds=SECONDS), arm_log(seed=2, seconds=SECONDS))
    shift = {"Delta": 1e-3, "t_1": 0.0}
    before, later = ({**shift, "t_1": instant_s} for instant_s in (0.0, 5.0))
    hypothesis = nominal_hypothesis(case, -1.5).with_effects({"arm.weight_shift": before})
    assert not happened(case, hypothesis)
    assert happened(case, hypothesis.with_own("arm.weight_shift", {0: before, 1: later, ELSEWHERE: before}))
