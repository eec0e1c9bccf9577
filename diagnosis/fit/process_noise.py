"""The noise of a hypothesis, by maximum likelihood: what drives each axis at random, and how long dry friction is in doubt at rest."""

from dataclasses import replace

import numpy as np

from diagnosis.fit.gauss_newton import Fit, likelihood_of
from diagnosis.fit.profile_likelihood import Changed, Point, along
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, scaled
from diagnosis.hypothesis.initial_state import FIRST_REST_DOUBT

LEAST_NOISE, MOST_NOISE = -5.0, 1.5  # log10 rad/s per sqrt(s)
# The most is where it starts: longer doubt would take the part of friction that gives before it slides.
LEAST_DOUBT = -7.0  # log10 s
FIRST_STEP = 0.3
DOUBT_STEPS = 2.0  # of those of the process noise: a level of friction tells less of it


def with_process_noise(case: Case, hypothesis: Hypothesis, first: float = FIRST_STEP) -> Hypothesis:
    """The same with the noise that the innovations show."""
    return _likeliest(case, hypothesis, likelihood_of(case, hypothesis), first)


def process_noise_of(case: Case, found: Fit, first: float = FIRST_STEP) -> Hypothesis:
    """What was fitted with the noise that the innovations then show."""
    return _likeliest(case, found.hypothesis, found.log_likelihood, first)


def _likeliest(case: Case, hypothesis: Hypothesis, value: float, first: float) -> Hypothesis:
    """The likeliest noise, axis after axis; `value` is the log likelihood as it is."""
    for axis in range(len(hypothesis.process_noise)):
        start = Point(float(hypothesis.process_noise[axis]), hypothesis, value)
        hypothesis, value = along(case, start, _of_axis(case, axis), first)
    if _rubs(case, hypothesis):
        hypothesis, _ = along(case, Point(hypothesis.rest_doubt, hypothesis, value), _of_rest, DOUBT_STEPS * first)
    return hypothesis


def _rubs(case: Case, hypothesis: Hypothesis) -> bool:
    """Whether any axis has dry friction, stated or supposed."""
    library = case.library
    supposed = any(library.effects[name].holds_at_rest for name in hypothesis.effects)
    return supposed or len(library.frictionless) < len(library.bound.model.axes)


def _of_axis(case: Case, axis: int) -> Changed:
    """All noise of an axis: what comes and goes grows with what is white."""

    def changed(hypothesis: Hypothesis, x: float) -> Hypothesis:
        return scaled(case, hypothesis, axis, float(np.clip(x, LEAST_NOISE, MOST_NOISE)))

    return changed


def _of_rest(hypothesis: Hypothesis, x: float) -> Hypothesis:
    return replace(hypothesis, rest_doubt=float(np.clip(x, LEAST_DOUBT, FIRST_REST_DOUBT)))
