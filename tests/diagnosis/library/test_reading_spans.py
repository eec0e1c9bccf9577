"""Readings that may be off by anything within a span are charged once for each error that they share."""

import numpy as np
import pytest

from diagnosis.library.reading_spans import UniformError, charge, less_sure
from tests.diagnosis.library.test_sensor_effects import STEP, readings


def test_readings_that_share_an_error_are_as_sure_together_as_one() -> None:
    # Truth: a uniform error within a span has the variance span^2 / 12; four readings that share it say what one does, and cost it once.
    plain = readings(STEP * np.arange(12))
    rows, span = np.array([4, 5, 6, 7]), 10.0 * STEP
    found = less_sure(plain, 0, rows, np.full(4, 4.0), UniformError(span, 0.3))
    assert found.r[rows, 0] - plain.r[rows, 0] == pytest.approx(4.0 * span**2 / 12.0)
    assert np.sum(1.0 / (found.r[rows, 0] - plain.r[rows, 0])) == pytest.approx(12.0 / span**2)
    counted = plain.place[rows, 0] >= 0
    own = 0.5 * np.log(found.r[rows, 0] / plain.r[rows, 0])[counted].sum()
    assert found.known - plain.known - own == pytest.approx(-0.3 * counted.sum() / 4.0)


def test_a_span_much_smaller_than_the_noise_costs_nothing() -> None:
    plain = readings(STEP * np.arange(12))
    assert charge(plain, 0, 1e-6 * STEP) == pytest.approx(0.0, abs=1e-9)
    assert charge(plain, 0, np.sqrt(12.0 * plain.single[0])) == pytest.approx(0.5 * np.log(2.0))
