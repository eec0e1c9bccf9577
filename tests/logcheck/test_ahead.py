"""What the plant says of an output a little later is where it goes in a run of that plant."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.ahead import read_ahead, states_along, with_axes_as_read
from sim.bind import BoundPlant
from sim.simulate import Conditions, simulate
from twinlaw import fly


def test_read_ahead_from_its_own_states_a_run_is_where_it_goes(arm: BoundPlant) -> None:
    """Truth: the run itself, 30 rows behind each start, to a nanoradian."""
    log = fly(arm)
    run = simulate(arm, log.t_s, np.zeros(2), log.u, Conditions(resolution=[0.0], keep="yx"))
    assert run.x is not None
    assert run.y is not None
    log, starts = replace(log, y=run.y), np.array([50, 400, 900])
    found = read_ahead(log, arm, "theta_rad", starts, run.x[starts], 30)
    assert found == pytest.approx(run.y[starts + 30, 0], abs=1e-9)


def test_axes_that_were_read_replace_those_of_a_free_run(arm: BoundPlant) -> None:
    states = states_along(fly(arm), arm)[[10, 20]]
    read = {"theta_rad": (np.array([0.1, 0.2]), np.array([1.0, 2.0]))}
    assert with_axes_as_read(arm, states, read).tolist() == [[0.1, 1.0], [0.2, 2.0]]
