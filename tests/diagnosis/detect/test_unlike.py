"""What promises most beside what was taken already is tried next, not what looks like it."""

import numpy as np
import pytest

from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.starts import ScoreTest
from diagnosis.detect.unlike import unlike
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

RUBS = {"arm.coulomb": {"b": 6e-4}}
FALLS = {"b_s": 6e-4, "v_s": 30.0, "e": 2.0}  # at no speed that is flown: dry friction by another name
LATE = {"tau": 0.02, "jitter": 0.0}


def promising(effect: str, values: dict[str, float], gain: float) -> ScoreTest:
    return ScoreTest(effect, values, np.sqrt(2.0 * gain), gain, 0.0, 1.0)


@pytest.fixture(scope="module")
def plain() -> Linearisation:
    case = arm_case(arm_log(RUBS, seed=76))
    return linearised(case, nominal_fit(case))


def test_a_second_cause_is_tried_before_what_looks_like_the_first(plain: Linearisation) -> None:
    # Truth by hand: two laws of friction that are one at the speeds flown promise 30 and 29 nats, a late sensor 12.
    rubs, falls = promising("arm.coulomb", RUBS["arm.coulomb"], 30.0), promising("arm.stribeck", FALLS, 29.0)
    late = promising("theta_sensor.delay", LATE, 12.0)
    other = promising("theta_sensor.lag", {"tau": 0.02}, 11.0)
    assert unlike(plain, [rubs, falls, late], 1) == [rubs, late]
    assert unlike(plain, [rubs, falls, late, other], 2) == [rubs, falls, late]
    assert unlike(plain, [rubs, falls], 2) == [rubs, falls]
