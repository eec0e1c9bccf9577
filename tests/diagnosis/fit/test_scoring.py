"""Scoring of noise by logs whose noise is known."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.gauss_newton import likelihood_of
from diagnosis.fit.process_noise import LEAST_NOISE, axis_noise
from diagnosis.fit.scoring import LITTLE_PROMISED, likeliest_numbers
from tests.diagnosis.arm import plain_linearisation


@pytest.mark.parametrize("away", [-1.5, 0.0, 1.5])
def test_the_likeliest_noise_is_found_from_decades_away(away: float) -> None:
    # Truth: the best of a fine grid of the first axis' noise, the rest as found.
    linearisation = plain_linearisation()
    case, fitted = linearisation.case, linearisation.fit.hypothesis
    begun = replace(fitted, process_noise=fitted.process_noise + away)
    found, value = likeliest_numbers(case, begun, axis_noise(case, begun))
    noise = axis_noise(case, found)[0]
    grid = [likelihood_of(case, noise.put(found, noise.of(found) + by)) for by in np.linspace(-1.0, 1.0, 41)]
    assert value == likelihood_of(case, found)
    assert max(grid) < value + 0.3


def test_a_hypothesis_that_is_likeliest_stays() -> None:
    linearisation = plain_linearisation()
    case, fitted = linearisation.case, linearisation.fit.hypothesis
    found, value = likeliest_numbers(case, fitted, axis_noise(case, fitted))
    again, same = likeliest_numbers(case, found, axis_noise(case, found))
    assert again is found
    assert same == value


def test_noise_that_is_next_to_none_is_found_again() -> None:
    # Where a torque that came and goes is taken away, the white noise beside it may be far too little for slopes of size.
    linearisation = plain_linearisation()
    case, fitted = linearisation.case, linearisation.fit.hypothesis
    best, value = likeliest_numbers(case, fitted, axis_noise(case, fitted))
    begun = replace(best, process_noise=np.full_like(best.process_noise, LEAST_NOISE))
    found, there = likeliest_numbers(case, begun, axis_noise(case, begun))
    assert there > value - LITTLE_PROMISED
    assert found.process_noise == pytest.approx(best.process_noise, abs=0.1)
