"""Shares within margins, correlation and fits of predictions whose errors are known by construction."""

import math

import numpy as np
import pytest

from diagnosis.validate.agreement import agreements, nrmse_fit_percent

T_S = 0.01 * np.arange(400)
ANGLE = 0.5 * np.sin(T_S)


def test_an_error_of_two_degrees_over_a_quarter_of_the_time_is_outside_then() -> None:
    # Truth: 1.5 deg is the margin of an attitude, and the error is 2 deg in the first of four windows of 1 s, 1 deg in the others.
    error = np.radians(np.where(T_S < 1.0 - 1e-9, 2.0, 1.0))
    found = agreements(["psi_rad"], [(T_S, ANGLE[:, None], {"nominal": (ANGLE + error)[:, None]})])
    assert found["psi_rad"].margin == pytest.approx(math.radians(1.5))
    assert found["psi_rad"].inside_margin["nominal"] == pytest.approx(0.75)
    # A constant error changes no rate: what jumps between two windows is no rate of either.
    assert found["psi_rad_s"].margin == pytest.approx(math.radians(3.0))
    assert found["psi_rad_s"].inside_margin["nominal"] == 1.0


def test_a_drift_within_each_window_is_a_rate() -> None:
    # Truth: predictions that drift off at 4 deg/s leave the rate's margin always, the angle's after 1.5 / 4 s of each window.
    drift = np.radians(4.0) * (T_S % 1.0)
    found = agreements(["psi_rad"], [(T_S, ANGLE[:, None], {"after": (ANGLE + drift)[:, None]})])
    assert found["psi_rad_s"].inside_margin["after"] == 0.0
    assert found["psi_rad"].inside_margin["after"] == pytest.approx(0.38, abs=0.011)


def test_a_length_has_no_margin_and_a_still_output_no_correlation() -> None:
    still = np.full((400, 1), 0.1)
    found = agreements(["q_m"], [(T_S, still, {"before": still + 1e-3})])["q_m"]
    assert found.margin is None
    assert found.inside_margin == {}
    assert found.correlation == {}
    assert set(agreements(["q_m"], [(T_S, still, {"before": still})])) == {"q_m"}


def test_fits_of_a_worked_example() -> None:
    # Deviations from the mean are (-2, 2, 0), those of the estimate (-1, 3, 1): |e| = sqrt(3), |y - mean| = sqrt(8).
    y, found = np.array([1.0, 5.0, 3.0]), np.array([2.0, 6.0, 4.0])
    assert nrmse_fit_percent(y, found) == pytest.approx(100.0 * (1.0 - math.sqrt(3.0 / 8.0)))
    told = agreements(["x_m"], [(np.arange(3) * 0.1, y[:, None], {"after": found[:, None]})])["x_m"]
    theil = math.sqrt(3.0) / (math.sqrt(8.0) + math.sqrt(11.0))
    assert told.theil_fit_percent["after"] == pytest.approx(100.0 * (1.0 - theil))
    assert told.correlation["after"] == pytest.approx(1.0)
