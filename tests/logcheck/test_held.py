"""Single readings that repeat the one before are left out where the axis went on, and kept where an encoder may repeat itself."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.held import stale_findings
from records.log import RunLog
from tests.logcheck.test_parts import STEP_RAD, STEPS, log_of, rounded


def stale_rows(log: RunLog) -> np.ndarray:
    found = [entry.excluded for entry in stale_findings(log, "a", STEPS, ("psi_rad", "phi_rad"))]
    return np.any(found, axis=0) if found else np.zeros(len(log.t_s), bool)


def repeated(log: RunLog, rows: np.ndarray) -> RunLog:
    """The first output as it is read where a new reading did not come in time for these rows."""
    y = log.y.copy()
    for row in np.flatnonzero(rows):
        y[row, 0] = y[row - 1, 0]
    return replace(log, y=y)


@pytest.mark.parametrize("share", [0.01, 0.05])
def test_late_readings_of_a_moving_axis_are_left_out_and_no_true_one_is(share: float) -> None:
    log = log_of()
    log.y[:, 0] = rounded(0.8 * np.sin(1.3 * log.t_s))  # up to 7 steps a row
    late = np.random.default_rng(5).random(2000) < share
    late[0] = False
    spoilt = repeated(log, late)
    found, off = stale_rows(spoilt), np.abs(spoilt.y[:, 0] - log.y[:, 0])
    assert not (found & (off == 0.0)).any()
    assert found[off > 3.5 * STEP_RAD].mean() > 0.7  # late twice within three rows, none tells how fast the axis was


def test_an_honest_encoder_repeats_itself_and_an_axis_stops_and_starts_without_a_word() -> None:
    log = log_of()
    assert not stale_rows(log).any()
    y = log.y.copy()
    y[:, 0] = STEP_RAD * np.cumsum(np.where(np.arange(2000) % 40 < 20, 0, 3))
    assert not stale_rows(replace(log, y=y)).any()
