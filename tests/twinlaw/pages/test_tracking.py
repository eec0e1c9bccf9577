"""What is said of a flight that did not stay with its references."""

from dataclasses import replace

import numpy as np

from sim.activity import activity
from sim.tracking import Tracking
from twinlaw.pages.run.tracking import left_sentence

T_S = np.arange(100) * 0.01
GOOD = Tracking(
    output="x_m",
    holds=4,
    overshoot=0.1,
    settling_s=2.0,
    steady_error_rad=0.0,
    mean_error_rad=0.01,
    push_rad=0.0,
    input="i_A",
    activity=activity(T_S, np.sin(T_S)),
    step_rad=0.1,
)


def test_a_flight_that_overshoots_by_more_than_its_step_has_left_its_references() -> None:
    assert left_sentence([GOOD]) == ""
    told = left_sentence([GOOD, replace(GOOD, output="y_m", overshoot=1.96)])
    assert told.startswith("the flight left its references, y_m, which overshoots a step by 196 %")
