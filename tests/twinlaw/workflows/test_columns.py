"""Where an identification looks to doubt its columns, and what it says of them once a fit has failed."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.decide.columns import COLUMNS_ROWS
from records.errors import BadInput
from tests.diagnosis.arm import arm, arm_log
from tests.replay.firmware_flights import own, plant, rows_of
from twinlaw.workflows.columns import demand_columns, where_most_moves
from twinlaw.workflows.identify.columns import asked_for_columns, asked_for_ranges
from twinlaw.workflows.identify.inputs import Inputs, looked_at


def test_of_a_long_log_the_rows_in_which_its_outputs_travel_most_are_looked_at() -> None:
    log = arm_log(seconds=60.0)
    y = log.y.copy()
    y[:900], y[400] = y[900], np.nan  # at rest at first
    part = where_most_moves(replace(log, y=y))
    assert 8.9 <= part.t_s[0] <= 20.0
    assert len(part.t_s) == COLUMNS_ROWS
    assert where_most_moves(part) is part


def test_a_column_that_was_never_read_says_nothing_of_where_most_moves() -> None:
    log = arm_log(seconds=60.0)
    beside = replace(log, y=np.hstack((log.y, np.full_like(log.y, np.nan))))
    assert where_most_moves(beside).t_s[0] == where_most_moves(log).t_s[0]


def test_a_column_that_is_turned_is_refused_or_doubted_and_no_honest_one() -> None:
    log = arm_log(seconds=16.0)  # long enough to tell a row too
    assert demand_columns(arm(), {"a": log}) == ()
    with pytest.raises(BadInput, match="theta_rad has the wrong sign"):
        demand_columns(arm(), {"a": replace(log, y=-log.y)})


def test_commands_a_row_late_are_refused() -> None:
    """Truth: each command stands in the row after its own; one a second is 2 V larger, which a lag does not make up for."""
    log = arm_log(seconds=16.0, kick_V=2.0)
    with pytest.raises(BadInput, match="u_V stands one row late"):
        demand_columns(arm(), {"a": replace(log, u=np.concatenate([log.u[:1], log.u[:-1]]))})


def test_an_input_whose_sign_turns_beside_the_rows_in_which_most_moves_is_refused_too() -> None:
    """Truth: of 42 s of an arm, of which the end tells least, the input is logged as -u from 41 s on."""
    log = arm_log(seconds=42.0)
    assert where_most_moves(log).t_s[-1] < 41.0
    u = log.u.copy()
    u[4100:] *= -1.0
    with pytest.raises(BadInput, match=r"u_V has the wrong sign in a from (40\.9\d|41|41\.0\d) s on: "):
        demand_columns(arm(), {"a": replace(log, u=u)})


def test_readings_where_a_sensor_s_range_ends_are_told_and_left_out_of_the_fit_and_of_what_is_predicted() -> None:
    """Truth: an arm's sensor that reads up to 0.8 of the way."""
    log = arm_log(seed=7)
    y = log.y[:, 0]
    level = float(y[np.argmin(np.abs(y - np.min(y) - 0.8 * np.ptp(y)))])
    cut_off = replace(log, y=np.minimum(log.y, level))
    asked = asked_for_ranges(Inputs((), {"a": cut_off}, {"b": cut_off}), arm())
    for each in (asked.logs["a"], asked.holdout["b"]):
        np.testing.assert_array_equal(np.isnan(each.y), cut_off.y == level)
    (said,) = asked.notes
    assert said.startswith(f"a: theta_rad never exceeds {level:.5g} rad")
    assert asked_for_ranges(Inputs((), {"a": log}, {}), arm()).notes == ()


def test_rows_of_which_every_second_was_written_stand_before_the_estimates_and_are_no_green() -> None:
    """Truth: a closed loop at 10 ms, whose log holds every second row, and says 10 ms."""
    log = own()
    thinned = rows_of(log, np.arange(len(log.t_s)) % 2 == 0)
    inputs = asked_for_columns(looked_at(Inputs((), {"thinned": thinned, "own": log}, {}), plant()), plant())
    assert inputs.doubt.startswith("thinned: the rows are 0.02 s apart, not 0.01 s: 1 in 2 was written")
    assert not any("1 in 2 was written" in note for note in inputs.notes)
