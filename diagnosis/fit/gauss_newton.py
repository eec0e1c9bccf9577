"""Maximum a posteriori fit of a hypothesis: Gauss-Newton with Levenberg's damping on the whitened innovations.

It is no use of identification/fit/levenberg_marquardt.py: what is maximised is a likelihood and no sum of squares, as ln s goes with what
is fitted, and each point costs a filter's pass over all logs. So steps begin undamped, are damped a few times only where the likelihood
falls, and end where one gains or promises less than LEAST_STEP_GAIN nats, which no sum of squares counts in.
"""

from dataclasses import replace

import numpy as np

from diagnosis.fit.free_numbers import free_numbers
from diagnosis.fit.known_before import add_prior
from diagnosis.fit.linear_problem import Fit, linear, log_posterior_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, nominal_hypothesis

LEAST_STEP_GAIN = 0.1  # gain of the log posterior below which a fit has ended
LITTLE_NATS = (
    1.0  # gained by a round of several fits, or promised by a step, below which it is the last: a tenth of TAKEN_IN
)
# Of a step that is too long: tried as it is, then shorter by more and more, down to a third of it.
DAMPINGS, FIRST_DAMPING, MORE_DAMPING = 4, 0.06, 6.0


def fit(case: Case, start: Hypothesis, *, rounds: int = 8, shapes: bool = True) -> Fit | None:
    """The best theta and effects from `start`, process noise held; None where the start cannot be filtered."""
    free = free_numbers(case, start, shapes)
    at = linear(case, start, free)
    damping = 0.0
    for _ in range(rounds):
        if at is None:
            return None
        if damping == 0.0 and at.promised < LEAST_STEP_GAIN:
            return at
        for tried in range(DAMPINGS):
            moved = _moved(case, at, damping)
            # Most steps end at the first that is tried: its slopes come along.
            is_asked = tried == 0 or log_posterior_of(case, moved, free) > at.log_posterior
            fitted = linear(case, moved, free, at.log_posterior) if is_asked else None
            if fitted is not None:
                break
            damping = max(MORE_DAMPING * damping, FIRST_DAMPING)
        else:
            return at
        gain, at = fitted.log_posterior - at.log_posterior, fitted
        damping *= 0.2
        if gain < LEAST_STEP_GAIN:
            break
    return at


def _moved(case: Case, at: Fit, damping: float) -> Hypothesis:
    """One damped step, kept within the effects' bounds. A number counts for no less than its unit in it: one of which the logs tell next to
    nothing, as a shape of no size yet, would else go as far as ever however much all others are held back."""
    count = len(case.free)
    theta = at.hypothesis.theta
    curvature = at.information + damping * np.diag(np.diag(at.information) + 1.0)
    step = -np.linalg.solve(curvature, at.pull)
    moved = replace(at.hypothesis, theta=theta + step[:count])
    for entry, change in zip(at.free, step[count:], strict=True):
        value = entry.of(moved) + float(np.clip(change, -30.0, 30.0)) * entry.scale
        value = float(np.clip(value, entry.parameter.lower, entry.parameter.upper))
        moved = moved.with_value(entry.effect, entry.parameter.symbol, value, entry.log)
    return moved


def unfitted(case: Case, noisy: Hypothesis) -> Fit | None:
    """The plant as stated with the noise of another hypothesis, no more known of it than its file says; None where it cannot follow the
    logs."""
    gusts = {name: values for name, values in noisy.effects.items() if case.library.effects[name].is_noise}
    stated = nominal_hypothesis(case, 0.0).with_noise_of(noisy)
    start = fit(case, stated.with_effects({**stated.effects, **gusts}), rounds=0)
    if start is None:
        return None
    information, pull = np.zeros_like(start.information), np.zeros_like(start.pull)
    add_prior(case, start.hypothesis, start.free, information, pull)
    return replace(start, information=information, pull=pull)
