"""What is known of a hypothesis' numbers before any log is seen: theta and what the plant file states, sizes of effects, wide."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.fit.free_numbers import Free, from_zero
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis

Array = NDArray[np.float64]


def log_prior(case: Case, hypothesis: Hypothesis, free: Sequence[Free]) -> float:
    """Of theta, standard normal, of numbers that the plant file states, likewise, and of sizes, wide."""
    sizes = [
        (entry.of(hypothesis) - (entry.parameter.zero or 0.0)) / entry.scale / decisions.SIZE_SD
        for entry in free
        if from_zero(entry.parameter) and entry.stated is None
    ]
    return -0.5 * prior_chi_squared(case, hypothesis, free) - 0.5 * float(np.sum(np.square(sizes)))


def away(hypothesis: Hypothesis, free: Sequence[Free]) -> Array:
    """How far all numbers that the plant file states are from there, in standard deviations: theta, then those of its effects."""
    stated = [(entry.of(hypothesis) - entry.stated) / entry.scale for entry in free if entry.stated is not None]
    return np.append(hypothesis.theta, stated)


def prior_chi_squared(case: Case, hypothesis: Hypothesis, free: Sequence[Free]) -> float:
    """The squared distance of all that the plant file states from there, in its own spread: chi-squared under a plant as stated."""
    moved, theta = away(hypothesis, free), hypothesis.theta
    beside = 0.0 if case.spread is None else float(theta @ (case.pull_of(theta) - theta))
    return float(moved @ moved) + beside


def add_prior(case: Case, hypothesis: Hypothesis, free: Sequence[Free], information: Array, pull: Array) -> None:
    """Add it to a linear problem in place: `information` (k, k) and `pull` (k,), theta first, then `free`."""
    count = len(hypothesis.theta)
    information[:count, :count] += case.known
    pull[:count] += case.pull_of(hypothesis.theta)
    for row, entry in enumerate(free, count):
        value = entry.of(hypothesis)
        if entry.stated is not None:
            information[row, row] += 1.0
            pull[row] += (value - entry.stated) / entry.scale
            continue
        size = value - (entry.parameter.zero or 0.0)
        information[row, row] += 1.0 / decisions.SIZE_SD**2 if from_zero(entry.parameter) else 1e-6
        pull[row] += size / entry.scale / decisions.SIZE_SD**2 if from_zero(entry.parameter) else 0.0
