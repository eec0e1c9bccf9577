"""The sweep's truth is its definition: where it begins and ends, how long it lasts, and which wishes are refused."""

import math

import numpy as np
import pytest

from identification.frequency.flights.plant_sweep import band_of
from identification.frequency.flights.sweep import design_sweep, highest_rad_s, phase_rad, record_s, sweep_input
from records.errors import BadInput

PERIOD_S = 0.02


def test_it_runs_from_the_lowest_frequency_to_the_highest():
    sweep = design_sweep(0.5, 10.0, PERIOD_S)
    t_s = np.linspace(0.0, sweep.sweep_s, 20001)
    omega = np.gradient(phase_rad(sweep, t_s), t_s)
    np.testing.assert_allclose(omega[t_s < 2.0 * math.pi / 0.5], 0.5, rtol=1e-3)  # one whole period of the lowest
    np.testing.assert_allclose(omega[-1], 10.0, rtol=5e-3)
    assert np.all(np.diff(omega) > -1e-6)


@pytest.mark.parametrize(("slowest", "band"), [(2.7, (0.3, 10.0)), (15.0, (0.3, 10.0)), (0.27, (0.03, 1.0))])
def test_a_slower_loop_is_swept_as_much_slower(slowest, band):
    # Truth: the CE150's loops, slowest pole at -2.7 rad/s, are swept from 0.3 to 10 rad/s.
    assert band_of(slowest) == pytest.approx(band)


def test_it_begins_and_ends_in_trim_and_keeps_its_amplitude():
    sweep = design_sweep(0.5, 10.0, PERIOD_S)
    t_s = PERIOD_S * np.arange(round(sweep.duration_s / PERIOD_S))
    u = sweep_input(sweep, t_s, 0.7)
    outside = (t_s < sweep.rest_s) | (t_s > sweep.rest_s + sweep.sweep_s)
    assert np.all(u[outside] == 0.0)
    assert 0.69 < np.max(np.abs(u)) <= 0.7


def test_a_sweep_too_short_for_its_lowest_frequency_says_how_long_it_must_be_or_where_to_begin():
    assert record_s(0.5) == pytest.approx(4.0 * 2.0 * math.pi / 0.5)
    with pytest.raises(BadInput, match=r"duration: got 30 s, expected at least 50\.27 s.*begin at 0\.838 rad/s"):
        design_sweep(0.5, 10.0, PERIOD_S, 30.0)


@pytest.mark.parametrize(("low", "high"), [(0.0, 5.0), (5.0, 1.0), (math.nan, 5.0), (1.0, math.inf)])
def test_a_band_that_is_none_is_refused(low, high):
    with pytest.raises(BadInput, match="band"):
        design_sweep(low, high, PERIOD_S)


def test_a_band_beyond_five_readings_a_period_is_refused():
    assert highest_rad_s(PERIOD_S) == pytest.approx(62.83, rel=1e-4)
    with pytest.raises(BadInput, match="five readings a period"):
        design_sweep(0.5, 63.0, PERIOD_S)
