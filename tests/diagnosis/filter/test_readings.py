"""What readings of a count, and of one that noise moves, are worth together: no more than they say."""

import numpy as np
import pytest

from diagnosis.filter.readings import readings_of

STEP = 1.5e-3
ROUNDING = STEP**2 / 12.0
ROWS = 200


def worth(read: np.ndarray) -> float:
    """The variance of the mean of readings of an axis at rest, each with the weight that it is given."""
    found = readings_of(0.01 * np.arange(len(read)), read, np.ones(len(read), dtype=bool), STEP, ROUNDING)
    return float(1.0 / np.sum(1.0 / found.r))


def at_rest(noise_steps: float, rounded: bool) -> tuple[np.ndarray, np.ndarray]:
    """The true errors of the means of fifty rests anywhere between counts, and what each says of its own variance."""
    rng = np.random.default_rng(5)
    errors, told = [], []
    for angle in rng.uniform(0.0, STEP, 50):
        before = STEP * np.round(angle / STEP) if rounded else angle
        read = STEP * np.round((before + noise_steps * STEP * rng.standard_normal(ROWS)) / STEP)
        errors.append(float(np.mean(read)) - angle)
        told.append(worth(read))
    return np.array(errors), np.array(told)


def test_a_count_read_again_and_again_is_worth_one_reading() -> None:
    assert worth(np.full(ROWS, 7 * STEP)) == pytest.approx(ROUNDING)


@pytest.mark.parametrize("noise_steps", [0.25, 1.0 / 3.0])
def test_noise_that_moves_a_count_leaves_its_rounding(noise_steps: float) -> None:
    # Readings to which noise was added behind the encoder: their mean is off by one rounding, however many they are. What they say of their
    # own variance is the mean square of their errors, to a factor of two.
    errors, told = at_rest(noise_steps, rounded=True)
    assert 0.5 < np.mean(errors**2) / np.mean(told) < 2.0


@pytest.mark.parametrize(("noise_steps", "least"), [(0.1, 0.5), (0.2, 0.5), (0.4, 0.0)])
def test_noise_before_a_rounding_dithers_it(noise_steps: float, least: float) -> None:
    # Truth: near an edge counts that noise moves to and fro tell where the axis is, between edges a count that stands tells its step. What
    # readings say of their own variance is the mean square of their errors to a factor of two; of more noise they say less than they could.
    errors, told = at_rest(noise_steps, rounded=False)
    assert least < np.mean(errors**2) / np.mean(told) < 2.0


def test_noise_of_several_steps_makes_rounding_new_with_each_reading() -> None:
    # Truth: the mean of n readings under white noise of two steps is as sure as 4 steps^2 / n.
    errors, told = at_rest(2.0, rounded=False)
    assert np.mean(told) == pytest.approx((4.0 + 1.0 / 12.0) * STEP**2 / ROWS, rel=0.25)
    assert 0.5 < np.mean(errors**2) / np.mean(told) < 2.0


def test_what_is_not_used_is_no_reading() -> None:
    # A stretch that nobody may use tells how noise moves the others, and says nothing of the output.
    read, used = np.repeat([0.0, STEP, 2 * STEP], 20), np.repeat([True, False, True], 20)
    found = readings_of(0.01 * np.arange(60), read, used, STEP, ROUNDING)
    assert np.array_equal(np.isfinite(found.y), used)
