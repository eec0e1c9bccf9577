"""Stands of a column by hand: where they are, how evenly an axis comes to them and leaves, and what an input set going."""

import numpy as np
import pytest

from logcheck.integrity import examine
from logcheck.stands.column import Readings, evenness, is_set_going, runs
from tests.diagnosis.arm import arm, arm_log


def column(values: np.ndarray) -> Readings:
    """Readings of a mass every 10 ms, its input at rest."""
    rows = np.arange(len(values))
    none = np.zeros(len(values), bool)
    return Readings(rows, 0.01 * rows, values, np.zeros((len(values), 1)), none, 0.01, True)


def test_a_stand_is_told_by_its_first_and_last_rows() -> None:
    values = np.concatenate([np.arange(20.0), np.full(20, 19.0), np.arange(18.0, -2.0, -1.0)])
    assert runs(values) == [(19, 39)]


def test_what_is_cut_off_comes_as_fast_as_before_and_what_brakes_a_third_as_fast() -> None:
    """Truth: at even speed both stretches of time see the same way; under an even brake 100 - 0 and 400 - 100, a third."""
    even = column(np.concatenate([np.arange(40.0), np.full(20, 39.0)]))
    braked = column(np.concatenate([1000.0 - np.arange(40.0, 0.0, -1.0) ** 2, np.full(20, 1000.0)]))
    assert evenness(even, 39, -1, far=10.0, most_rows=15) == pytest.approx(1.0, abs=1e-12)
    assert evenness(braked, 40, -1, far=100.0, most_rows=15) == pytest.approx(1.0 / 3.0, abs=1e-12)


def test_rows_in_which_another_log_begins_tell_of_no_speed() -> None:
    even = column(np.concatenate([np.arange(40.0), np.full(20, 39.0)]))
    even.begins[30] = True
    assert evenness(even, 39, -1, far=10.0, most_rows=15) == 0.0


def test_an_input_sets_going_what_stands_only_by_its_last_move() -> None:
    late, early = np.zeros((60, 1)), np.zeros((60, 1))
    late[45:] = early[20:] = 1.0
    answers = [is_set_going(u, 10, 50, 10, np.ptp(late, axis=0)) for u in (late, early)]
    assert answers == [True, False]


@pytest.mark.parametrize(("b_Nm", "seeds"), [(4e-4, (27, 29, 30)), (1e-3, (3, 6, 13))])
def test_dry_friction_that_stops_an_arm_is_no_sensor_that_was_not_read(b_Nm: float, seeds: tuple[int, ...]) -> None:
    # Truth: every sensor was read, and friction stops the arm from 0.1 rad/s within a row, for a third of a second and for several. Of a
    # hundred and eighty such runs a stand passes for one that was not read in 28.
    logs = [arm_log({"arm.coulomb": {"b": b_Nm}}, seed=seed, rows=4, seconds=20.0) for seed in seeds]
    found = [finding.kind for log in logs for finding in examine([log], arm(), names=["log"]).findings]
    assert "dead_stretch" not in found
