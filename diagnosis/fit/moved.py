"""Which numbers that the plant file states a fit moved far from there."""

import numpy as np

from diagnosis.fit.free_numbers import Free
from diagnosis.fit.known_before import away
from diagnosis.fit.linear_problem import Fit


def moved_parameters(theta: np.ndarray, far: float) -> list[int]:
    """Free coefficients (indices into theta) further than `far` from what is stated, the furthest first."""
    return [index for index in np.argsort(-np.abs(theta)).tolist() if abs(theta[index]) > far]


def moved_effects(fit: Fit, far: float) -> list[Free]:
    """Numbers of effects that the plant file states, further than `far` from there."""
    numbers = [entry for entry in fit.free if entry.stated is not None]
    distances = away(fit.hypothesis, fit.free)[len(fit.hypothesis.theta) :]
    return [entry for entry, distance in zip(numbers, distances.tolist(), strict=True) if abs(distance) > far]
