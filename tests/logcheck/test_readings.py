"""Readings that stand, repeat, leap or are no numbers are left out where they are; an axis that stops is not."""

from dataclasses import replace

import numpy as np
import pytest

from tests.logcheck.flight import TURN_STEP_RAD, clean, examined, kinds, other_flight, with_column


def test_an_axis_that_is_declared_locked_may_stand() -> None:
    log = with_column(clean(), "phi_rad", np.full(2001, 0.2))
    assert kinds(examined(replace(log, locked=("azimuth",)))) == {"constant"}


@pytest.mark.parametrize("period", [2, 7])
def test_readings_that_are_repeated_until_the_next_one_are_left_out(period: int) -> None:
    # Rows 3, 3 + m, ... hold fresh readings, as the sensor was sampled from there on at every m-th row of the log.
    log, rows = clean(), np.arange(2001)
    fresh = np.maximum((rows - 3) // period * period + 3, 3 - period * (3 // period))
    found = examined(replace(log, y=log.y[fresh]))
    assert kinds(found, "exclude") == {"held_readings"}
    excluded = found.logs[0].excluded
    assert not excluded[(rows % period == 3 % period) & (rows >= 3)].any()
    assert excluded.mean() == pytest.approx(1.0 - 1.0 / period, abs=0.01)


def test_missing_numbers_glitches_and_rows_beyond_the_stops_are_found_where_they_are() -> None:
    log = clean()
    y = log.y.copy()
    y[100:103, 0], y[700, 1], y[1200:1205, 0] = np.nan, y[700, 1] + 1.0, 1.2
    found = examined(replace(log, y=y))
    assert kinds(found) == {"not_a_number", "glitch", "beyond_stops", "dead_stretch"}
    unread = np.argwhere(found.logs[0].unread).tolist()
    assert unread == [[700, 1], [1200, 0], [1201, 0], [1202, 0], [1203, 0], [1204, 0]]


@pytest.mark.parametrize("column", ["psi_rad", "omega_M_rad_s", "psi_dot_rad_s", "psi_ref_rad"])
def test_a_column_that_was_never_measured_is_noted_without_warnings(
    column: str, recwarn: pytest.WarningsRecorder
) -> None:
    found = examined(with_column(clean(), column, np.full(2001, np.nan)), holdout=[other_flight()])
    assert [(finding.kind, finding.column) for finding in found.findings] == [("not_recorded", column)]
    assert not [str(warning.message) for warning in recwarn]


@pytest.mark.parametrize("rows", [30, 300])
def test_a_reading_that_stops_is_left_out_from_when_to_when_with_its_jumps(rows: int) -> None:
    log = clean()
    psi = log.y[:, 0].copy()
    psi[600 : 600 + rows] = 0.0
    jumps = [abs(psi[599]) / TURN_STEP_RAD, abs(psi[600 + rows]) / TURN_STEP_RAD]
    assert min(jumps) > 30.0
    (found,) = examined(with_column(log, "psi_rad", psi)).findings
    assert (found.kind, found.column, found.severity) == ("dead_stretch", "psi_rad", "exclude")
    assert [found.start_s, found.end_s] == pytest.approx([6.0, 5.99 + 0.01 * rows])
    assert f"jumps there by {jumps[0]:.0f} steps, it jumps away by {jumps[1]:.0f} steps" in found.sentence


def test_a_reading_that_freezes_amid_motion_is_noted_and_an_axis_that_stops_is_not() -> None:
    log, rows = clean(), np.arange(2001)
    phi = log.y[:, 1]
    fastest = int(np.argmax(np.abs(phi[200:] - phi[:-200])))
    frozen = np.where((rows >= fastest) & (rows < fastest + 200), phi[fastest], phi)
    assert kinds(examined(with_column(log, "phi_rad", frozen))) == {"dead_stretch"}
    stopped = np.maximum(phi, phi[fastest + 5])  # a stop that takes all speed in one row
    assert "dead_stretch" not in kinds(examined(with_column(log, "phi_rad", stopped)))


def test_a_link_that_fails_for_a_second_is_noted_by_output_and_is_no_seam() -> None:
    log, rows = clean(), np.arange(2001)
    fastest = int(np.argmax(np.abs(log.y[100:] - log.y[:-100]).min(axis=1)))
    frozen = replace(log, y=log.y[np.where((rows > fastest) & (rows < fastest + 100), fastest, rows)])
    found = examined(frozen).findings
    assert [(finding.kind, finding.column) for finding in found] == [
        ("dead_stretch", "psi_rad"),
        ("dead_stretch", "phi_rad"),
    ]
