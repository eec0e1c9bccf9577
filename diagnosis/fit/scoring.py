"""Noise and other numbers that slopes of innovations under fixed gains tell nothing of, by maximum likelihood: Fisher's scoring.

(1)  2 ln L = -sum (ln s + nu^2 / s),   g_i = d ln L / dx_i
(2)  I_ik = sum (d ln s / dx_i d ln s / dx_k / 2 + d nu / dx_i d nu / dx_k / s),   x <- x + I^-1 g

(Harvey 1989, section 3.4.5), s the innovations' variances. The filter's own pass gives both, so that numbers which do the same part of the
noise give way to each other at once.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.kalman import Pass
from diagnosis.fit.gauss_newton import LITTLE_NATS
from diagnosis.fit.likelihood import likelihood
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes

Array = NDArray[np.float64]
NUDGE = 1e-4  # decades, over which slopes of the noise itself are taken
MOST_SCORING_STEPS = 10
NEARLY_THERE = 3.0 * LITTLE_NATS  # promised, and half of them found: of so near a top one step leaves less than little
UNKNOWN_SD = 1e3  # decades: next to nothing is known beforehand
STEP_SHARES = (1.0, 0.3, 0.1)  # of a step that are tried
FURTHEST = 1.0  # decades in one step
TWICE = 2.0 * float(np.log(10.0))  # of a decade of a number, that its variance grows by


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
    at, runs = start, _passes(case, start, numbers)
    if runs is None:
        return start, -np.inf
    for _ in range(MOST_SCORING_STEPS if numbers else 0):
        g, information = _linear(at, runs, numbers)
        step, single = _step(at, numbers, g, information), _single(at, numbers, g, information)
        promises = [_promised(g, information, one) for one in single]
        promised = max(_promised(g, information, step), *promises)
        if promised < LITTLE_NATS:
            break
        alone = [single[place] for place in np.argsort(promises)[::-1] if promises[place] > NEARLY_THERE]
        tries = _tries(at, numbers, step, alone)
        better = _better(case, tries, numbers, _worth(at, runs, numbers) + LITTLE_NATS)
        if better is None:
            break
        gained = _worth(*better, numbers) - _worth(at, runs, numbers)
        at, runs = better
        if promised < NEARLY_THERE and gained > 0.5 * promised:
            break
    return at, likelihood(runs)


def _worth(hypothesis: Hypothesis, runs: Sequence[Pass], numbers: Sequence[Number]) -> float:
    return likelihood(runs) - 0.5 * sum(number.away(hypothesis) ** 2 for number in numbers)


def _better(
    case: Case, tries: Iterable[Hypothesis], numbers: Sequence[Number], least: float
) -> tuple[Hypothesis, list[Pass]] | None:
    """The first of the tries that is worth more than `least`, with its slopes: of the first these come along, as most steps end there."""
    for place, tried in enumerate(tries):
        runs = _passes(case, tried, numbers if place == 0 else ())
        if runs is None or _worth(tried, runs, numbers) <= least:
            continue
        sloped = runs if place == 0 else _passes(case, tried, numbers)
        return None if sloped is None else (tried, sloped)
    return None


def _passes(case: Case, hypothesis: Hypothesis, numbers: Sequence[Number]) -> list[Pass] | None:
    """The filter with its slopes by the numbers; those at a bound that hold them have none."""
    return passes(case, hypothesis, noises=[_nudged(hypothesis, number) for number in numbers])


def _nudged(hypothesis: Hypothesis, number: Number) -> tuple[Hypothesis, float]:
    x = number.of(hypothesis)
    tried = [(number.put(hypothesis, x + by), by) for by in (NUDGE, -NUDGE)]
    return next(((other, by) for other, by in tried if number.of(other) != x), tried[0])


def _step(hypothesis: Hypothesis, numbers: Sequence[Number], g: Array, information: Array) -> Array:
    """I^-1 g among the numbers that no bound keeps from going there, none of them further than `_kept`."""
    free, step = np.ones(len(numbers), dtype=bool), np.zeros(len(numbers))
    while free.any():
        left = g - information @ np.where(free, 0.0, step)
        step[free] = np.linalg.solve(information[np.ix_(free, free)], left[free])
        blocked = [_is_blocked(hypothesis, *told) for told in zip(numbers, step.tolist(), strict=True)]
        near = np.where(blocked, 0.0, _kept(step))
        kept, step = free & (near == step), near
        if (kept == free).all():
            break
        free = kept
    return step


def _promised(g: Array, information: Array, step: Array) -> float:
    return float(g @ step - 0.5 * step @ information @ step)


def _is_blocked(hypothesis: Hypothesis, number: Number, step: float) -> bool:
    x = number.of(hypothesis)
    return number.of(number.put(hypothesis, x + float(np.copysign(NUDGE, step)))) == x


def _single(hypothesis: Hypothesis, numbers: Sequence[Number], g: Array, information: Array) -> Array:
    """The step of each number alone, along a row (numbers, numbers); none of one that a bound keeps from going there."""
    steps = _kept(g / np.diag(information))
    return np.diag(
        [0.0 if _is_blocked(hypothesis, *told) else told[1] for told in zip(numbers, steps.tolist(), strict=True)]
    )


def _tries(
    hypothesis: Hypothesis, numbers: Sequence[Number], step: Array, alone: Sequence[Array]
) -> Iterator[Hypothesis]:
    """Where the likelihood may be higher: shares of the whole step; and where axes stick, and slopes lead nowhere, each step `alone`."""
    yield from (_moved(hypothesis, numbers, share * _decades(step)) for share in STEP_SHARES)
    yield from (_moved(hypothesis, numbers, _decades(one)) for one in alone)


def _moved(hypothesis: Hypothesis, numbers: Sequence[Number], decades: Array) -> Hypothesis:
    for number, change in zip(numbers, decades.tolist(), strict=True):
        hypothesis = number.put(hypothesis, number.of(hypothesis) + change) if change else hypothesis
    return hypothesis


def _decades(step: Array) -> Array:
    """Those of numbers by a step in variances, which `_kept` has kept near."""
    return np.asarray(np.log1p(TWICE * step) / TWICE)


def _kept(step: Array) -> Array:
    """A step straight in the variances, where one of them makes all innovations it ends at the top; none goes further than FURTHEST."""
    least, most = (np.expm1(TWICE * by) / TWICE for by in (-FURTHEST, FURTHEST))
    return np.asarray(np.clip(step, least, most))


def _linear(hypothesis: Hypothesis, runs: Sequence[Pass], numbers: Sequence[Number]) -> tuple[Array, Array]:
    """g and I of (2) by the numbers, with what is known of them."""
    known = np.array([number.known[1] for number in numbers])
    away = np.array([number.away(hypothesis) for number in numbers])
    return sum(run.score for run in runs) - away / known, sum(run.information for run in runs) + np.diag(1.0 / known**2)
