"""What is said of a flight that did not stay with its references."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from records.log import RunLog
from records.logs.columns import LogColumns
from records.loops import Loop
from sim.activity import activity
from sim.tracking import Tracking, tracking
from twinlaw.pages.quality import quality_told
from twinlaw.pages.run.tracking import flight_quality, left_sentence, out_of_reach, tracking_facts

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


def test_a_red_flight_whose_input_stands_at_its_limit_names_it_and_asks_for_smaller_references() -> None:
    """Truth: 3 s without a pause at 2 A of a current that may be -2 A to 2 A, and half a second more; x rests 0.04 m short."""
    t_s = np.arange(600) * 0.01
    loop = Loop("x", "x_m", "i_A", "motor")
    i_A = np.where((t_s > 1.995) & (t_s < 5.005) | (t_s > 5.495), 2.0, 0.5)[:, None]
    columns = LogColumns("slide", ("i_A",), ("x_m",), (), ("x",))
    log = RunLog(
        columns, 0.01, "closed", t_s, i_A, np.full((600, 1), 0.06), {"x_ref_m": np.where(t_s < 1.0, 0.06, 0.1)}
    )
    found = tracking(log, loop, (-2.0, 2.0))
    assert found.at_limit_s == pytest.approx(3.0)
    told = left_sentence([found])
    assert told.startswith(
        "i_A stands at its limit of 2 A for 3 s on end: the references of x_m lie beyond what it can do. Fly smaller ones"
    )
    assert "reference_max_m" in told
    assert "stands" not in left_sentence([tracking(log, loop)])
    assert left_sentence([replace(GOOD, at_limit_s=3.0)]) == ""


def test_what_the_first_line_told_is_not_told_again_behind_the_colour() -> None:
    """Truth: 10 % of overshoot are amber, and 30 % red; both with the input at its limit for 3 s."""
    amber = replace(GOOD, at_limit_s=3.0, limit_V=2.0)
    red = replace(amber, output="y_m", overshoot=0.3)
    assert [line.startswith("i_A stands at its limit of 2 A") for line in out_of_reach([amber, red])] == [True, True]
    first, quality = left_sentence([amber, red]), flight_quality([amber, red])
    told = quality_told(quality, "\n".join(out_of_reach([amber, red])), first)
    assert "references of y_m lie beyond" in first
    assert "references of x_m lie beyond" in told
    assert "references of y_m lie beyond" not in told
    assert out_of_reach([replace(amber, overshoot=0.0)]) == []


def test_an_input_that_a_sensors_steps_move_off_its_limit_for_some_samples_rests_there() -> None:
    """Truth: of 300 samples from 2 s on, all at 2 A but each fourth; x rests 1 mm short of 100 mm, which is amber. A loop that
    throws its input from one limit to the other, a third of the time at each, rests at none."""
    t_s = np.arange(600) * 0.01
    loop = Loop("x", "x_m", "i_A", "motor")
    columns = LogColumns("slide", ("i_A",), ("x_m",), (), ("x",))
    reference = np.where(t_s < 1.0, 0.0, 0.1)
    settled = np.where(t_s < 1.5, reference, 0.099)[:, None]

    def flown(i_A: NDArray[np.float64]) -> Tracking:
        log = RunLog(columns, 0.01, "closed", t_s, i_A[:, None], settled, {"x_ref_m": reference})
        return tracking(log, loop, (-2.0, 2.0))

    resting = flown(np.where((t_s > 2.0) & (np.arange(600) % 4 > 0), 2.0, 1.5))
    assert resting.at_limit_s < 0.1
    assert resting.rest_limit_V == 2.0
    told = (
        "i_A stands at its limit of 2 A for most of the second before the next step: the references of x_m lie beyond"
    )
    assert [line.startswith(told) for line in out_of_reach([resting])] == [True]
    assert tracking_facts([resting])["tracking"]["x_m"]["rest_limit_A"] == 2.0
    assert out_of_reach([replace(resting, steady_error_rad=0.0)]) == []
    assert flown(2.0 * (np.arange(600) % 3 - 1.0)).rest_limit_V is None
