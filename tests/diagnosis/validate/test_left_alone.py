"""A model that has what the rig has follows it to the end of a log; one that lacks it does not."""

from dataclasses import replace

import numpy as np

from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.validate.left_alone import left_alone
from tests.diagnosis.arm import arm_case, arm_log

FRICTION = {"arm.coulomb": {"b": 6e-4}}
STEP_RAD = 1.150486e-3


def test_a_whole_run_is_followed_by_the_right_model_alone() -> None:
    case = arm_case(arm_log(FRICTION, seconds=10.0))
    plain = nominal_hypothesis(case, -2.0)
    right = plain.with_effects(FRICTION)
    found = left_alone(case, {"nominal": plain, "before": plain, "after": right})
    assert found is not None
    # The rig's own torque noise and the encoder's steps of 1.15 mrad are what the right model cannot follow.
    assert found.rms_after["theta_rad"] < 5.0 * STEP_RAD < 0.2 * found.rms_before["theta_rad"]
    assert found.rms_nominal == found.rms_before
    before, after, floor = (found.rms_before, found.rms_after, found.rms_floor)
    gone = (before["theta_rad"] ** 2 - after["theta_rad"] ** 2) / (before["theta_rad"] ** 2 - floor["theta_rad"] ** 2)
    assert found.fraction is not None
    np.testing.assert_allclose(found.fraction, gone, rtol=1e-9)


def test_nothing_is_said_of_a_log_that_ends_before_the_filter_knows_the_speeds() -> None:
    log = arm_log(seconds=5.0)
    brief = replace(log, t_s=log.t_s[:150], u=log.u[:150], y=log.y[:150])
    case = arm_case(brief)
    plain = nominal_hypothesis(case, -2.0)
    assert left_alone(case, dict.fromkeys(("nominal", "before", "after"), plain)) is None
