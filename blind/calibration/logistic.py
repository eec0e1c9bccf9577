"""A logistic law fitted to examples, with weight decay: each answer names several causes, the first with a share of what all have,

(1)  P(the first is right) = share / (1 + exp(-intercept - coefficients . features))
"""

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
SLOPE = 1e-7  # nats per unit, at which the fit is at its end


@dataclass(frozen=True)
class Law:
    """log odds that one of the names is right = intercept + coefficients . features."""

    intercept: float
    coefficients: tuple[float, ...]

    def probability(self, examples: Sequence[Example]) -> Array:
        """Of each example that its first name is right, by (1)."""
        features = np.array([entry.features for entry in examples], float)
        shares = np.array([entry.share for entry in examples], float)
        return np.asarray(shares * expit(self.intercept + features @ np.array(self.coefficients)))


def fit(examples: Sequence[Example], decay: float) -> Law:
    """The most probable law beforehand normal with variance 1 / `decay` in each coefficient per standard deviation of its feature.

    So the fit is defined with few examples and forgets units; a feature that does not vary has coefficient 0.
    """
    features = np.array([entry.features for entry in examples], float)
    right = np.array([entry.right for entry in examples], float)
    shares = np.array([entry.share for entry in examples], float)
    mean, sd = features.mean(axis=0), features.std(axis=0)
    varies = sd > SAME
    told = np.column_stack([np.ones(len(right)), (features - mean)[:, varies] / sd[varies]])
    numbers = _numbers(told, shares, right, np.array([INTERCEPT_DECAY, *[decay] * int(varies.sum())]))
    coefficients = np.zeros(len(sd))
    coefficients[varies] = numbers[1:] / sd[varies]
    return Law(float(numbers[0] - coefficients @ mean), tuple(coefficients.tolist()))


def _numbers(told: Array, shares: Array, right: Array, decay: Array) -> Array:
    """Where log loss plus decay is least, in nats."""

    def loss(w: Array) -> float:
        z = told @ w
        wrong = np.logaddexp(0.0, z) - z - np.log(1.0 - shares + np.exp(-z))
        return float(np.sum(right * np.logaddexp(0.0, -z) + (1.0 - right) * wrong) + 0.5 * decay @ w**2)

    def slope(w: Array) -> Array:
        q = expit(told @ w)
        steep = (1.0 - right) * shares * q / (1.0 + (1.0 - shares) * np.exp(told @ w)) - right * (1.0 - q)
        return np.asarray(told.T @ steep + decay * w)

    return np.asarray(minimize(loss, np.zeros(told.shape[1]), jac=slope, method="BFGS", options={"gtol": SLOPE}).x)
