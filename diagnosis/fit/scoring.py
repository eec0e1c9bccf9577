"""Noise and other numbers that slopes of innovations under fixed gains tell nothing of, by maximum likelihood: Fisher's scoring.

(1)  2 ln L = -sum (ln s + nu^2 / s),   g_i = d ln L / dx_i
(2)  I_ik = sum (d ln s / dx_i d ln s / dx_k / 2 + d nu / dx_i d nu / dx_k / s),   x <- x + I^-1 g

(Harvey 1989, section 3.4.5), s the innovations' variances. One pass more for each number gives both, so that numbers which do the same
part of the noise give way to each other at once.
"""

from collections.abc import Callable, Iterator, Sequence
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
# Of ln s and of a whitened innovation: more than a nudge makes of them. Beyond, an axis came to rest a row earlier: no slope.
JUMP, FAR = 0.3, 1.0
MOST_STEPS = 10
LITTLE_PROMISED = 1.0  # nats: a tenth of what tells two names apart (TAKEN_IN)
NEARLY_THERE = 3.0  # nats promised, and half of them found: of so near a top one step leaves less than little
UNKNOWN_SD = 1e3  # decades: next to nothing is known beforehand
SHARES = (1.0, 0.3, 0.1)  # of a step that are tried
FURTHEST = 1.0  # decades in one step
ACROSS = 0.3  # decades, over a ridge or a hollow that an axis makes which comes to rest


@dataclass(frozen=True, eq=False)
class Number:
    """The log10 of a number that a hypothesis has: where it is, and a hypothesis with another, kept within its bounds; what is known of it
    beforehand, a normal law's middle and standard deviation in decades."""

    of: Callable[[Hypothesis], float]
    put: Callable[[Hypothesis, float], Hypothesis]
    known: tuple[float, float] = (0.0, UNKNOWN_SD)

    def away(self, hypothesis: Hypothesis) -> float:
        """How far it is from what is known, in standard deviations."""
        return (self.of(hypothesis) - self.known[0]) / self.known[1]


def likeliest_numbers(case: Case, start: Hypothesis, numbers: Sequence[Number]) -> tuple[Hypothesis, float]:
    """The hypothesis with the most probable of those numbers nearby, and its log likelihood; -inf where the filter left all bounds."""

    def worth(runs: Sequence[Pass], hypothesis: Hypothesis) -> float:
        return likelihood(runs) - 0.5 * sum(number.away(hypothesis) ** 2 for number in numbers)

    at, runs = start, passes(case, start)
    if runs is None:
        return start, -np.inf
    for _ in range(MOST_STEPS if numbers else 0):
        g, information = _linear(case, at, runs, numbers)
        step = _step(at, numbers, g, information)
        promised, before = 0.5 * float(g @ step), worth(runs, at)
        if promised < LITTLE_PROMISED:
            break
        alone = np.asarray(g / np.diag(information), float) if promised > NEARLY_THERE else None
        for moved in _tries(at, numbers, step, alone):
            there = passes(case, moved)
            if there is not None and worth(there, moved) > before + LITTLE_PROMISED:
                at, runs = moved, there
                break
        gained = worth(runs, at) - before
        if gained < LITTLE_PROMISED or (promised < NEARLY_THERE and gained > 0.5 * promised):
            break
    return at, likelihood(runs)


def _step(hypothesis: Hypothesis, numbers: Sequence[Number], g: Array, information: Array) -> Array:
    """I^-1 g among the numbers that no bound keeps from going there."""
    free, step = list(range(len(numbers))), np.zeros(len(numbers))
    while free:
        step[free] = np.linalg.solve(information[np.ix_(free, free)], g[free])
        kept = [place for place in free if not _is_blocked(hypothesis, numbers[place], float(step[place]))]
        if kept == free:
            break
        step[:], free = 0.0, kept
    return step


def _is_blocked(hypothesis: Hypothesis, number: Number, step: float) -> bool:
    x = number.of(hypothesis)
    return number.of(number.put(hypothesis, x + float(np.copysign(NUDGE, step)))) == x


def _tries(hypothesis: Hypothesis, numbers: Sequence[Number], step: Array, alone: Array | None) -> Iterator[Hypothesis]:
    """Where the likelihood may be higher: shares of the whole step; where axes stick, and slopes lead nowhere, one number `alone`, by its
    own step or by ACROSS; not where so little is promised that it may be noise of the likelihood."""
    for share in SHARES:
        yield _moved(hypothesis, numbers, step, share)
    if alone is None:
        return
    for place in np.argsort(-np.abs(alone)).tolist():
        yield _moved(hypothesis, [numbers[place]], alone[[place]], SHARES[0])
    for number in numbers:
        yield from (number.put(hypothesis, number.of(hypothesis) + by) for by in (ACROSS, -ACROSS))


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
    known = np.array([number.known[1] for number in numbers])
    return g - [number.away(hypothesis) for number in numbers] / known, information + np.diag(1.0 / known**2)


def _slope(
    case: Case, hypothesis: Hypothesis, runs: Sequence[Pass], number: Number
) -> tuple[tuple[float, float], Array]:
    """A nudge of one number and what it gains in likelihood where that is smooth; and the slopes of ln s / sqrt(2) and of nu / sqrt(s), in
    a row."""
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
        before, after = stacked(runs), stacked(others)
        changed = after * np.sqrt(np.nan_to_num(ratio, nan=1.0)) - before
        smooth = (np.abs(np.log(ratio)) < JUMP) & (np.abs(changed) < FAR)
        spread, changed = np.where(smooth, np.log(ratio), 0.0), np.where(smooth, changed, 0.0)
        gained = -0.5 * float(np.sum(spread + np.where(smooth, after**2 - before**2, 0.0)))
        return (nudge, gained), np.concatenate([spread / np.sqrt(2.0), changed]) / nudge
    return (NUDGE, 0.0), none
