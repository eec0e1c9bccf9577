"""Rosenbrock's valley, curved and narrow: where searches are asked to follow it to its end at (1, 1)."""

import numpy as np


def valley(x):
    """Its residuals at x (2,), whose sum of squares has the minimum 0 at (1, 1)."""
    return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]])
