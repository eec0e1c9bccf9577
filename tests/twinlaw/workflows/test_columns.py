"""Where an identification looks to doubt its columns, and what it says of them once a fit has failed."""

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.arm import arm, arm_log
from twinlaw.workflows.identify.columns import doubted_columns, where_most_moves


def test_of_a_long_log_the_seconds_in_which_its_outputs_travel_most_are_looked_at() -> None:
    log = arm_log(seconds=30.0)
    y = log.y.copy()
    y[:900], y[400] = y[900], np.nan  # at rest at first
    part = where_most_moves(replace(log, y=y))
    assert 8.9 <= part.t_s[0] <= 10.0
    assert part.t_s[-1] - part.t_s[0] == pytest.approx(20.0, abs=0.02)
    assert where_most_moves(part) is part


@pytest.mark.parametrize("turned", [False, True])
def test_a_reading_that_the_stated_plant_follows_better_is_named_and_none_of_honest_columns(turned: bool) -> None:
    log = arm_log(seconds=6.0)
    said = doubted_columns(arm(), {"a": replace(log, y=-log.y) if turned else log})
    assert said.startswith("perhaps theta_rad has the wrong sign: read so, ") if turned else said == ""
