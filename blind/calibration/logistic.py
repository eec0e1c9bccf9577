"""A logistic law fitted to examples: log odds of being right = intercept + coefficients . features, with weight decay."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit

from blind.calibration.examples import Example

Array = NDArray[np.float64]
# The intercept's own weight decay: a standard deviation of ten logits, which only keeps it finite where all answers are right.
INTERCEPT_DECAY = 0.01
SAME = 1e-9  # a feature with a smaller standard deviation does not vary
SLOPE = 1e-9  # nats per unit, at which the fit is at its end


@dataclass(frozen=True)
class Law:
    """log odds of being right = intercept + coefficients . features."""

    intercept: float
    coefficients: tuple[float, ...]

    def probability(self, examples: Sequence[Example]) -> Array:
        """Of each example that it is right."""
        features = np.array([entry.features for entry in examples], float)
        return np.asarray(expit(self.intercept + features @ np.array(self.coefficients)))


def fit(examples: Sequence[Example], decay: float) -> Law:
    """The most probable law beforehand normal with variance 1 / `decay` in each coefficient per standard deviation of its feature.

    So the fit is defined with few examples and forgets units; a feature that does not vary has coefficient 0.
    """
    features = np.array([entry.features for entry in examples], float)
    right = np.array([entry.right for entry in examples], float)
    mean, sd = features.mean(axis=0), features.std(axis=0)
    varies = sd > SAME
    told = np.column_stack([np.ones(len(right)), (features - mean)[:, varies] / sd[varies]])
    numbers = _numbers(told, right, np.array([INTERCEPT_DECAY, *[decay] * int(varies.sum())]))
    coefficients = np.zeros(len(sd))
    coefficients[varies] = numbers[1:] / sd[varies]
    return Law(float(numbers[0] - coefficients @ mean), tuple(coefficients.tolist()))


def _numbers(told: Array, right: Array, decay: Array) -> Array:
    """Where log loss plus decay is least, in nats; it is strictly convex."""

    def loss(w: Array) -> float:
        return float(np.sum(np.logaddexp(0.0, told @ w) - right * (told @ w)) + 0.5 * decay @ w**2)

    def slope(w: Array) -> Array:
        return np.asarray(told.T @ (expit(told @ w) - right) + decay * w)

    def curvature(w: Array) -> Array:
        p = expit(told @ w)
        return np.asarray((told.T * (p * (1.0 - p))) @ told + np.diag(decay))

    start = np.zeros(told.shape[1])
    return np.asarray(minimize(loss, start, jac=slope, hess=curvature, method="trust-exact", options={"gtol": SLOPE}).x)
