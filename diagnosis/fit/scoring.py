"""Noise and other numbers that slopes of innovations under fixed gains tell nothing of, by maximum likelihood: Fisher's scoring.

(1)  2 ln L = -sum (ln s + nu^2 / s),   g_i = d ln L / dx_i
(2)  I_ik = sum (d ln s / dx_i d ln s / dx_k / 2 + d nu / dx_i d nu / dx_k / s),   x <- x + I^-1 g

(Harvey 1989, section 3.4.5), s the innovations' variances. One pass more for each number gives both, so that numbers which do the same
part of the noise give way to each other at once.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.kalman import Pass
from diagnosis.fit.gauss_newton import likelihood, stacked
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes
from jobs.thread_map import thread_map

Array = NDArray[np.float64]
NUDGE = 0.05  # decades, over which slopes are taken
JUMP = 0.3  # of ln s: twice what a nudge makes of it; beyond, an axis came to rest a row earlier
MOST_STEPS = 10
LITTLE_PROMISED = 0.3  # nats
NEARLY_THERE = 3.0  # nats promised and found: of so near a top one step leaves less than little
KNOWN = 1e-2  # information (1/decade^2) of a number of which the logs tell nothing: to a factor of 10 decades
SHARES = (1.0, 0.3, 0.1)  # of a step that are tried
FURTHEST = 1.0  # decades in one step


@dataclass(frozen=True, eq=False)
class Number:
    """The log10 of a number that a hypothesis has: where it is, and a hypothesis with another, kept within its bounds."""

    of: Callable[[Hypothesis], float]
    put: Callable[[Hypothesis, float], Hypothesis]


def likeliest_numbers(case: Case, start: Hypothesis, numbers: Sequence[Number]) -> tuple[Hypothesis, float]:
    """The hypothesis with the likeliest of those numbers near its own, and its log likelihood, -inf where the filter left all bounds."""
    at, runs = start, passes(case, start)
    if runs is None:
        return start, -np.inf
    for _ in range(MOST_STEPS):
        g, information = _linear(case, at, runs, numbers)
        step = np.asarray(np.linalg.solve(information, g), float)
        promised, before = 0.5 * float(g @ step), likelihood(runs)
        if promised < LITTLE_PROMISED:
            break
        for share in SHARES:
            moved = _moved(at, numbers, step, share)
            there = passes(case, moved)
            if there is not None and likelihood(there) > before:
                at, runs = moved, there
                break
        if likelihood(runs) < before + LITTLE_PROMISED or (share == 1.0 and promised < NEARLY_THERE):
            break
    return at, likelihood(runs)


def _moved(hypothesis: Hypothesis, numbers: Sequence[Number], step: Array, share: float) -> Hypothesis:
    """A share of one step, straight in the variances: where one of them makes all innovations it ends at the top."""
    twice = 2.0 * np.log(10.0)
    decades = np.log1p(np.maximum(twice * step, np.expm1(-twice * FURTHEST))) / twice
    for number, change in zip(numbers, (share * np.minimum(decades, FURTHEST)).tolist(), strict=True):
        hypothesis = number.put(hypothesis, number.of(hypothesis) + change)
    return hypothesis


def _linear(case: Case, hypothesis: Hypothesis, runs: Sequence[Pass], numbers: Sequence[Number]) -> tuple[Array, Array]:
    """g and I of (2) by the numbers."""
    found = thread_map(lambda number: _slope(case, hypothesis, runs, number), numbers)
    changes = np.stack([change for _, change in found])
    information = changes @ changes.T
    curvature = np.diag(information)
    nudges = np.array([nudge for (nudge, _), _ in found])
    g = np.array([gained for (_, gained), _ in found]) / nudges + 0.5 * curvature * nudges
    return g, information + KNOWN * np.eye(len(numbers))


def _slope(
    case: Case, hypothesis: Hypothesis, runs: Sequence[Pass], number: Number
) -> tuple[tuple[float, float], Array]:
    """A nudge of one number and what it gains in likelihood; and the slopes of ln s / sqrt(2) and of nu / sqrt(s), in a row."""
    none = np.zeros(2 * stacked(runs).size)
    x = number.of(hypothesis)
    for nudge in (NUDGE, -NUDGE):
        there = number.put(hypothesis, x + nudge)
        if number.of(there) == x:
            continue  # at a bound
        others = passes(case, there)
        if others is None:
            continue
        ratio = np.concatenate([(other.s / one.s).ravel() for one, other in zip(runs, others, strict=True)])
        ratio = np.where(np.abs(np.log(ratio)) < JUMP, ratio, 1.0)
        changed = np.where(ratio == 1.0, 0.0, stacked(others) * np.sqrt(ratio) - stacked(runs))
        both = np.concatenate([np.log(ratio) / np.sqrt(2.0), changed]) / nudge
        return (nudge, likelihood(others) - likelihood(runs)), both
    return (NUDGE, 0.0), none
