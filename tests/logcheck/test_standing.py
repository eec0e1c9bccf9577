"""A log whose last part is no flight: the rig off, or its sensor no longer read."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.integrity import examine
from records.log import RunLog
from sim.bind import BoundPlant
from tests.own_plants import WORKING
from twinlaw import fly, load

OFF = 1334  # of 2001 rows: two thirds


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> BoundPlant:
    return load(str(WORKING["plain"].write(tmp_path_factory.mktemp("arm"), "my_arm")))


def kinds(arm: BoundPlant, log: RunLog) -> dict[str, float]:
    """Kinds of what is left out of a log, and from when."""
    found = examine([log], arm, names=["log"]).findings
    return {entry.kind: entry.start_s for entry in found if entry.severity == "exclude"}


def test_nothing_is_said_of_a_log_that_ends_as_it_began(arm: BoundPlant) -> None:
    log = fly(arm)
    for rows in range(400, 2001, 100):
        assert kinds(arm, replace(log, t_s=log.t_s[:rows], u=log.u[:rows], y=log.y[:rows])) == {}


def test_an_output_that_stands_to_the_end_under_moving_inputs_is_left_out_from_there(arm: BoundPlant) -> None:
    """Truth: the last reading is that of row 1400, at which the arm rests, so that no jump tells of the stand."""
    log = fly(arm)
    slow = int(np.argmin(np.abs(np.diff(log.y[1200:1500, 0])))) + 1200
    y = log.y.copy()
    y[slow:] = y[slow]
    found = kinds(arm, replace(log, y=y))
    assert found
    assert min(found.values()) == pytest.approx(log.t_s[slow], abs=0.2)


def test_a_rig_that_was_switched_off_is_left_out_from_there(arm: BoundPlant) -> None:
    log = fly(arm)
    far = int(np.argmax(np.abs(log.y[OFF:1700, 0]))) + OFF
    u, y = log.u.copy(), log.y.copy()
    u[far:], y[far:] = 0.0, 0.0
    assert kinds(arm, replace(log, u=u, y=y))["switched_off"] == pytest.approx(log.t_s[far])
