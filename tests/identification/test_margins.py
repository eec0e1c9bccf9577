"""Truth: values worked out by hand; Table 1.1 of seed 003 in feet and degrees."""

import math

import numpy as np
import pytest

from identification.margins import (
    MARGINS,
    FOOT_m,
    correlation,
    fit_percent,
    held_s,
    share_outside,
    theil,
)

MEASURED = np.array([3.0, 4.0, 0.0, 0.0])
ESTIMATED = np.array([0.0, 4.0, 0.0, 3.0])


def test_the_margins_are_those_of_table_1_1() -> None:
    level = {"u": 5, "v": 4, "w": 3, "p": 3, "q": 3, "r": 3, "phi": 1.5, "theta": 1.5, "A_x": 3, "A_y": 3, "A_z": 3}
    table = dict.fromkeys(("level", "descending", "autorotation"), level)
    table["ascending"] = level | {"w": 1.66, "theta": 3}
    for mission, row in table.items():
        found = [value / (math.radians(1) if "rad" in name else FOOT_m) for name, value in MARGINS[mission].items()]
        assert found == pytest.approx(list(row.values()), rel=1e-12)


def test_theil_and_fit_of_a_worked_example() -> None:
    # rms error sqrt(18 / 4), rms of both 5 / 2: U = sqrt(18) / 10.
    assert theil(MEASURED, ESTIMATED) == pytest.approx(math.sqrt(18.0) / 10.0, rel=1e-14)
    assert fit_percent(MEASURED, ESTIMATED) == pytest.approx(100.0 - 10.0 * math.sqrt(18.0), rel=1e-14)
    assert theil(MEASURED, -MEASURED) == pytest.approx(1.0, rel=1e-14)
    assert theil(np.zeros(3), np.zeros(3)) == 0.0


def test_correlation_of_a_worked_example() -> None:
    # Both have mean 7 / 4 and sum of squares 25, their product sums to 16: (16 - 49 / 4) / (25 - 49 / 4) = 5 / 17.
    assert correlation(MEASURED, ESTIMATED) == pytest.approx(5.0 / 17.0, rel=1e-13)
    assert correlation(MEASURED, 5.0 - 2.0 * MEASURED) == pytest.approx(-1.0, rel=1e-13)
    assert math.isnan(correlation(MEASURED, np.ones(4)))


def test_a_margin_itself_is_inside_and_nan_is_left_out() -> None:
    assert share_outside(MEASURED, ESTIMATED, 3.0) == 0.0
    assert share_outside(MEASURED, ESTIMATED, 2.9) == 0.5
    assert share_outside(np.array([0.0, math.nan, 2.0]), np.zeros(3), 1.0) == 0.5


def test_the_three_seconds_count_from_the_start_to_the_first_exit() -> None:
    measured = np.zeros(100)
    estimated = np.where(np.arange(100) == 40, 2.0, 0.0)
    assert held_s(measured, estimated, 1.0, 0.1) == pytest.approx(4.0)
    assert held_s(measured, np.zeros(100), 1.0, 0.1) == pytest.approx(10.0)
