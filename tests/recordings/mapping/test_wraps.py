"""Counters that ran over are counted on, and a clock that begins again for another recording is left to it."""

import numpy as np
import pytest

from recordings.mapping.wraps import angle_past_its_end, clock_past_its_end, counter_size

TICKS = np.arange(0.0, 6000.0, 10.0)


@pytest.mark.parametrize("size", [2.0**16, 2.0**24, 2.0**32])
def test_ticks_of_a_narrow_integer_count_on(size: float) -> None:
    counted, found = clock_past_its_end((TICKS + size - 3000.0) % size)
    assert found == size
    np.testing.assert_array_equal(counted - counted[0], TICKS)


@pytest.mark.parametrize("size", [2.0**16, 2.0**32])
def test_ticks_of_a_signed_integer_count_on(size: float) -> None:
    """Truth: from 3000 ticks before the integer's end, behind which it is least."""
    counted, found = clock_past_its_end((TICKS + size - 3000.0) % size - 0.5 * size)
    assert found == size
    np.testing.assert_array_equal(counted - counted[0], TICKS)


@pytest.mark.parametrize(
    "ticks",
    [
        TICKS,
        np.concatenate([TICKS, TICKS]),  # another recording
        np.concatenate([TICKS + 59000.0, TICKS]),  # which ends 540 ticks before an integer's end
        0.5 * TICKS % 1000.3,
    ],
)
def test_other_clocks_stay(ticks: np.ndarray) -> None:
    counted, found = clock_past_its_end(ticks)
    assert found is None
    assert counted is ticks


@pytest.mark.parametrize(("size", "amplitude"), [(360.0, 30.0), (65536.0, 900.0)])
def test_an_angle_within_one_range_is_counted_on_about_zero(size: float, amplitude: float) -> None:
    truth = amplitude * np.sin(0.02 * np.arange(900))
    truth[400] = np.nan  # not read
    counted, leaps, found = angle_past_its_end(truth % size, [7.0, size])
    assert (leaps, found) == (5, size)
    np.testing.assert_allclose(counted, truth, atol=1e-9 * size)


def test_an_angle_that_begins_below_zero_is_counted_on_in_the_branch_about_zero() -> None:
    # Truth: from -20 deg up to 10 deg and back; within a turn it begins at 340 deg.
    truth = -5.0 - 15.0 * np.cos(0.02 * np.arange(900))
    counted, leaps, _ = angle_past_its_end(truth % 360.0, [360.0])
    assert leaps > 0
    np.testing.assert_allclose(counted, truth, atol=1e-9)


def test_an_angle_that_is_lost_and_one_of_several_turns_stay() -> None:
    several = np.linspace(0.0, 900.0, 90)
    several[50] -= 360.0
    assert angle_past_its_end(several, [360.0])[1] == 0
    assert angle_past_its_end(np.full(9, np.nan), [360.0])[1] == 0


@pytest.mark.parametrize(("bits", "size"), [(0xFFFF, 65536.0), (0xFFFFFFFF, 2.0**32)])
def test_negative_counts_in_an_integer_without_sign_are_seen_by_its_range(bits: int, size: float) -> None:
    counts = np.round(300.0 * np.sin(0.02 * np.arange(900))).astype(np.int64)
    assert counter_size((counts & bits).astype(float)) == size
    assert counter_size(counts.astype(float)) is None
    assert counter_size((counts & bits) + 0.5) is None  # no counts
