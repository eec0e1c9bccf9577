"""What two logs have in common: rows of the hold-out, rows given twice, the same angle with another input."""

from dataclasses import replace

import numpy as np
import pytest

from tests.logcheck.flight import clean, examined, kinds, other_flight
from tests.replay.firmware_flights import rows_of


def test_a_holdout_that_overlaps_the_training_runs_is_refused_whatever_its_times() -> None:
    log = clean()
    part = rows_of(log, np.arange(2001) > 1500)
    found = examined(log, holdout=[replace(part, t_s=part.t_s - part.t_s[0])])
    assert kinds(found, "refuse") == {"holdout_overlap"}
    assert kinds(examined(log, holdout=[other_flight()])) == set()


def test_rows_given_twice_for_training_count_once() -> None:
    found = examined(clean(), clean())
    assert kinds(found) == {"duplicate_rows"}
    assert not found.logs[0].excluded.any()
    assert found.logs[1].excluded.mean() > 0.9


@pytest.mark.parametrize(("input_changes", "refused"), [(False, set()), (True, {"holdout_overlap"})])
def test_a_plant_left_alone_goes_the_same_way_again_and_is_no_copy(input_changes: bool, refused: set[str]) -> None:
    # Truth: 60 rows in which both angles come to rest alike, reading for reading, under inputs that stand; or with one step among them.
    rest = np.s_[900:960]
    logs = []
    for log in (clean(), other_flight()):
        u, y = log.u.copy(), log.y.copy()
        u[rest], y[rest] = [5.0, 2.0], np.round(0.3 * np.exp(-np.arange(60) / 20.0), 2)[:, None] * [1.0, 2.0]
        u[930:960, 1] += 0.5 * input_changes
        logs.append(replace(log, u=u, y=y))
    assert kinds(examined(logs[0], holdout=[logs[1]]), "refuse") == refused


@pytest.mark.parametrize(("alike", "refused"), [(60, set()), (600, {"holdout_overlap"})])
def test_free_swings_meet_on_their_way_and_copies_share_more_of_it(alike: int, refused: set[str]) -> None:
    # Truth: inputs that stand all along, and so many of 2001 rows alike, reading for reading.
    shared = np.s_[900 : 900 + alike]
    logs = [replace(log, u=np.zeros_like(log.u), y=log.y.copy(), extra={}) for log in (clean(), other_flight())]
    logs[1].y[shared] = logs[0].y[shared]
    assert kinds(examined(logs[0], holdout=[logs[1]]), "refuse") & {"holdout_overlap"} == refused


@pytest.mark.parametrize(("factor", "severity"), [(1.1, None), (1.5, "note"), (2.5, "note")])
def test_logs_that_hold_the_same_angle_with_another_input_are_told_and_not_refused(
    factor: float, severity: str | None
) -> None:
    other = other_flight()
    scaled = replace(other, u=np.column_stack([other.u[:, 0] / factor, other.u[:, 1]]))
    found = [finding for finding in examined(clean(), scaled).findings if finding.kind == "two_plants"]
    assert [finding.severity for finding in found] == ([] if severity is None else [severity])
