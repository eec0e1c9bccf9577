"""Scoring of noise by logs whose noise is known."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.coloured_noise import _time as time
from diagnosis.fit.coloured_noise import colours as colours
from diagnosis.fit.coloured_noise import size_of as size
from diagnosis.fit.gauss_newton import LITTLE_NATS
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.process_noise import LEAST_NOISE, axis_noise, white_noise
from diagnosis.fit.scoring import Number, likeliest_numbers
from diagnosis.fit.scoring import _passes as passes_by
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, noise_on, nominal_hypothesis, passes
from diagnosis.library.reading_noise import ReadingNoise
from sim.effect import Role
from tests.diagnosis.arm import arm_case, arm_log, plain_linearisation

NEARBY = 1e-3  # decades: further apart an axis that sticks may let go a row earlier, which is a jump of the likelihood and no slope


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
    assert there > value - LITTLE_NATS
    assert found.process_noise == pytest.approx(best.process_noise, abs=0.1)


def coloured(case: Case, hypothesis: Hypothesis) -> tuple[Hypothesis, list[Number]]:
    """A hypothesis with all noise that there is, some of it far from the likeliest, and all numbers of it."""
    gust = noise_on(case, 0)
    assert gust is not None
    values = {gust.symbol(Role.STRENGTH): 2e-4, gust.symbol(Role.MEMORY): 0.3}
    noisy = replace(
        hypothesis.with_effects({**hypothesis.effects, gust.name: values}),
        reading_noise={"theta_rad": ReadingNoise(5e-4, 0.05)},
        process_noise=hypothesis.process_noise - 0.3,
        rest_doubt=-3.0,
    )
    numbers = [*white_noise(case, noisy)]
    for colour in colours(case):
        numbers += [] if colour.of(noisy) is None else [size(colour), time(colour)]
    return noisy, numbers


@pytest.mark.parametrize("effects", [{}, {"arm.coulomb": {"b": 4e-4}}])
def test_slopes_by_all_noise_are_those_of_the_likelihood(effects: dict[str, dict[str, float]]) -> None:
    # Truth: differences of the likelihood over a thousandth of a decade to each side. The filter leaves out how its Jacobians move, with
    # the mean and with the time for which a torque is remembered: five per cent, or five nats a decade of some hundred.
    case = arm_case(arm_log(effects, seed=76))
    hypothesis, numbers = coloured(case, nominal_hypothesis(case, -1.5).with_effects(effects))
    assert len(numbers) == (6 if effects else 5)
    runs = passes_by(case, hypothesis, numbers)
    assert runs is not None
    found = sum(run.score for run in runs)
    for number, slope in zip(numbers, found, strict=True):
        there, back = (
            likelihood_of(case, number.put(hypothesis, number.of(hypothesis) + by)) for by in (NEARBY, -NEARBY)
        )
        assert slope == pytest.approx((there - back) / (2.0 * NEARBY), rel=0.05, abs=5.0)


def test_information_is_of_the_innovations_and_their_spread() -> None:
    # Truth by equation (2), of each number and of each two, from innovations and variances a little beside. What the filter leaves out, as
    # above, makes a twentieth of what two numbers share.
    linearisation = plain_linearisation()
    case = linearisation.case
    hypothesis, numbers = coloured(case, linearisation.fit.hypothesis)
    runs = passes_by(case, hypothesis, numbers)
    assert runs is not None
    changes = []
    for number in numbers:
        (there, back) = (passes(case, number.put(hypothesis, number.of(hypothesis) + by)) for by in (NEARBY, -NEARBY))
        assert there is not None
        assert back is not None
        spread = [(np.log(a.s) - np.log(b.s)) / np.sqrt(2.0) for a, b in zip(there, back, strict=True)]
        turned = [
            (a.w * np.sqrt(a.s) - b.w * np.sqrt(b.s)) / np.sqrt(run.s)
            for a, b, run in zip(there, back, runs, strict=True)
        ]
        changes.append(np.concatenate([np.ravel(part) for part in (*spread, *turned)]) / (2.0 * NEARBY))
    told = np.nan_to_num(changes)
    known, found = told @ told.T, sum(run.information for run in runs)
    unit = np.sqrt(np.outer(np.diag(known), np.diag(known)))
    assert np.asarray(found) / unit == pytest.approx(known / unit, abs=0.1)
