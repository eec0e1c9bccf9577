"""Figures of merit on made-up flights whose merits are known, and the spread of the plants."""

import numpy as np
import pytest

from tests.controllers.rows import ce150
from verification.comparison.conditions import spread
from verification.comparison.measures import merit

T_S = np.arange(2001) * 0.01
DEGREE = np.radians(1.0)


def test_the_merits_of_a_made_up_step() -> None:
    # Truth: a step of 10 deg at 10 s, answered at once with 12 deg for 1 s, then 10.5 deg to the end; 2 V before, 3 V from then on.
    reference = np.where(T_S >= 10.0, 10.0, 0.0) * DEGREE
    angle = np.where(T_S >= 11.0, 10.5, np.where(T_S >= 10.0, 12.0, 0.0)) * DEGREE
    voltage = np.where(T_S >= 15.0, 3.0, 2.0)
    columns = [np.column_stack([values, values]) for values in (reference, angle, voltage)]
    found = merit(T_S, *columns, 0)
    assert found.overshoot == pytest.approx(0.2)
    assert found.settling_s == pytest.approx(1.0)
    assert found.steady_error_rad == pytest.approx(0.5 * DEGREE)
    assert found.largest_error_rad == pytest.approx(0.5 * DEGREE)
    assert found.iae_rad_s == pytest.approx((2.0 + 0.5 * 9.01) * DEGREE)
    assert found.swing_V == pytest.approx(1.0)
    assert found.travel_V_s == pytest.approx(0.1)


def test_an_angle_that_leaves_the_band_at_the_end_never_settles() -> None:
    reference = np.where(T_S >= 10.0, 10.0, 0.0) * DEGREE
    angle = np.where(T_S >= 19.9, 12.0, reference / DEGREE) * DEGREE
    columns = [np.column_stack([values, values]) for values in (reference, angle, np.zeros(T_S.size))]
    assert merit(T_S, *columns, 1).settling_s is None


def test_spread_plants_are_within_ten_per_cent_and_what_is_exact_stays() -> None:
    drawn = spread(ce150(), 200, 1)
    plant = ce150()
    known = plant.sd > 0.0
    assert np.array_equal(drawn[:, ~known], np.tile(plant.p[~known], (200, 1)))
    ratio = drawn[:, known] / plant.p[known]
    assert 0.9 <= ratio.min() < 0.91
    assert 1.09 < ratio.max() <= 1.1
    assert np.array_equal(spread(plant, 200, 1), drawn)
    assert not np.array_equal(spread(plant, 200, 2), drawn)
