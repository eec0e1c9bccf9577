"""Process noise: what drives each axis' speed at random, by maximum likelihood."""

from dataclasses import replace

import numpy as np

from diagnosis.fit.gauss_newton import Fit, likelihood_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis

LEAST_NOISE, MOST_NOISE = -5.0, 1.5
FIRST_STEP = 0.3
MOST_STEPS = 12
LITTLE_PROMISED = (
    0.1  # nats that the top of the parabola, (below - above)^2 / (8 |bend|) higher, must promise to be looked at
)


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
    """Uphill in steps, then the top of the parabola through the last three points."""

    def at(process_noise: float) -> tuple[Hypothesis, float]:
        changed = hypothesis.process_noise.copy()
        changed[axis] = float(np.clip(process_noise, LEAST_NOISE, MOST_NOISE))
        fitted = replace(hypothesis, process_noise=changed)
        return fitted, likelihood_of(case, fitted)

    middle = (hypothesis, value)
    below, above = at(hypothesis.process_noise[axis] - step), at(hypothesis.process_noise[axis] + step)
    for _ in range(MOST_STEPS):
        if below[1] <= middle[1] >= above[1]:
            break
        if below[1] > above[1]:
            below, middle, above = at(below[0].process_noise[axis] - step), below, middle
        else:
            below, middle, above = middle, above, at(above[0].process_noise[axis] + step)
    bend = below[1] - 2.0 * middle[1] + above[1]
    if not (np.isfinite(bend) and bend < 0.0) or (below[1] - above[1]) ** 2 < -8.0 * bend * LITTLE_PROMISED:
        return middle
    top = at(middle[0].process_noise[axis] + 0.5 * step * (below[1] - above[1]) / bend)
    return top if top[1] > middle[1] else middle
