"""How restless the air and the drives are: the noise on each axis' speed, by maximum likelihood."""

from dataclasses import replace

import numpy as np

from diagnosis.fit.gauss_newton import Fit, likelihood_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Supposed

LEAST, MOST = -5.0, 1.5
FIRST_STEP = 0.3
MOST_STEPS = 12
LITTLE = 0.1  # nats that the top of the parabola, (below - above)^2 / (8 |bend|) higher, must promise to be looked at


def with_unrest(case: Case, supposed: Supposed, first: float = FIRST_STEP) -> Supposed:
    """The same with the unrest that the innovations show."""
    return _likeliest(case, supposed, likelihood_of(case, supposed), first)


def unrest_of(case: Case, found: Fit, first: float = FIRST_STEP) -> Supposed:
    """What was fitted with the unrest that the innovations then show."""
    return _likeliest(case, found.supposed, found.log_likelihood, first)


def _likeliest(case: Case, supposed: Supposed, value: float, first: float) -> Supposed:
    """The likeliest unrest, axis after axis; `value` is the log likelihood as it is."""
    for axis in range(len(supposed.unrest)):
        supposed, value = _along(case, supposed, value, axis, first)
    return supposed


def _along(case: Case, supposed: Supposed, value: float, axis: int, step: float) -> tuple[Supposed, float]:
    """Uphill in steps, then the top of the parabola through the last three points."""

    def at(unrest: float) -> tuple[Supposed, float]:
        changed = supposed.unrest.copy()
        changed[axis] = float(np.clip(unrest, LEAST, MOST))
        tried = replace(supposed, unrest=changed)
        return tried, likelihood_of(case, tried)

    middle = (supposed, value)
    below, above = at(supposed.unrest[axis] - step), at(supposed.unrest[axis] + step)
    for _ in range(MOST_STEPS):
        if below[1] <= middle[1] >= above[1]:
            break
        if below[1] > above[1]:
            below, middle, above = at(below[0].unrest[axis] - step), below, middle
        else:
            below, middle, above = middle, above, at(above[0].unrest[axis] + step)
    bend = below[1] - 2.0 * middle[1] + above[1]
    if not (np.isfinite(bend) and bend < 0.0) or (below[1] - above[1]) ** 2 < -8.0 * bend * LITTLE:
        return middle
    top = at(middle[0].unrest[axis] + 0.5 * step * (below[1] - above[1]) / bend)
    return top if top[1] > middle[1] else middle
