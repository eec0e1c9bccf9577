"""Process noise: what drives each axis' speed at random, by maximum likelihood."""

from dataclasses import replace

import numpy as np

from diagnosis.fit.gauss_newton import Fit, likelihood_of
from diagnosis.fit.profile_likelihood import Point, by_parabola
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis

LEAST_NOISE, MOST_NOISE = -5.0, 1.5
FIRST_STEP = 0.3
MOST_STEPS = 12
LITTLE_PROMISED = 0.1  # nats


def with_process_noise(case: Case, hypothesis: Hypothesis, first: float = FIRST_STEP) -> Hypothesis:
    """The same with the process noise that the innovations show."""
    return _likeliest(case, hypothesis, likelihood_of(case, hypothesis), first)


def process_noise_of(case: Case, found: Fit, first: float = FIRST_STEP) -> Hypothesis:
    """What was fitted with the process noise that the innovations then show."""
    return _likeliest(case, found.hypothesis, found.log_likelihood, first)


def _likeliest(case: Case, hypothesis: Hypothesis, value: float, first: float) -> Hypothesis:
    """The likeliest process noise, axis after axis; `value` is the log likelihood as it is."""
    for axis in range(len(hypothesis.process_noise)):
        hypothesis, value = _along(case, hypothesis, value, axis, first)
    return hypothesis


def _along(case: Case, hypothesis: Hypothesis, value: float, axis: int, step: float) -> tuple[Hypothesis, float]:
    """The likeliest noise of one axis, all others held."""

    def at(process_noise: float) -> Point:
        changed = hypothesis.process_noise.copy()
        changed[axis] = x = float(np.clip(process_noise, LEAST_NOISE, MOST_NOISE))
        there = replace(hypothesis, process_noise=changed)
        return Point(x, there, likelihood_of(case, there))

    start = Point(float(hypothesis.process_noise[axis]), hypothesis, value)
    found = by_parabola(at, start, step, MOST_STEPS, LITTLE_PROMISED)
    return found.hypothesis, found.value
