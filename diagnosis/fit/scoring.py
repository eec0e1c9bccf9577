"""Noise and other numbers that slopes of innovations under fixed gains tell nothing of, by maximum likelihood: Fisher's scoring.

(1)  2 ln L = -sum (ln s + nu^2 / s),   g_i = d ln L / dx_i
(2)  I_ik = sum (d ln s / dx_i d ln s / dx_k / 2 + d nu / dx_i d nu / dx_k / s),   x <- x + I^-1 g

(Harvey 1989, section 3.4.5), s the innovations' variances. The filter's own pass gives both, so that numbers which do the same part of the
noise give way to each other at once.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.kalman import Pass
from diagnosis.fit.gauss_newton import likelihood
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes

Array = NDArray[np.float64]
NUDGE = 1e-4  # decades, over which slopes of the noise itself are taken
MOST_STEPS = 10
LITTLE_PROMISED = 1.0  # nats: a tenth of what tells two names apart (TAKEN_IN)
NEARLY_THERE = 3.0  # nats promised, and half of them found: of so near a top one step leaves less than little
UNKNOWN_SD = 1e3  # decades: next to nothing is known beforehand
DAMPINGS = (
    0.0,
    1.0,
    10.0,
    100.0,
)  # the first that helps is taken: of 217 steps that failed whole 131 helped with the second, 161 with the third
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
    at, runs, first = start, _passes(case, start, numbers), 0
    if runs is None:
        return start, -np.inf
    for _ in range(MOST_STEPS if numbers else 0):
        g, information = _linear(at, runs, numbers)
        steps = [_step(at, numbers, g, _damped(information, damping)) for damping in DAMPINGS[first:]]
        promises = [_promised(g, information, step) for step in steps]
        if max(promises) < LITTLE_PROMISED:
            break
        tries = {
            place: _moved(at, numbers, steps[place])
            for place, promise in enumerate(promises)
            if promise > LITTLE_PROMISED
        }
        better = _better(case, tries, numbers, _worth(at, runs, numbers) + LITTLE_PROMISED)
        if better is None:
            break
        place, moved, sloped = better
        gained = _worth(moved, sloped, numbers) - _worth(at, runs, numbers)
        at, runs = moved, sloped
        first = max(first + place - 1, 0)
        if max(promises) < NEARLY_THERE and gained > 0.5 * max(promises):
            break
    return at, likelihood(runs)


def _worth(hypothesis: Hypothesis, runs: Sequence[Pass], numbers: Sequence[Number]) -> float:
    return likelihood(runs) - 0.5 * sum(number.away(hypothesis) ** 2 for number in numbers)


def _better(
    case: Case, tries: Mapping[int, Hypothesis], numbers: Sequence[Number], least: float
) -> tuple[int, Hypothesis, list[Pass]] | None:
    """The first of the tries that is worth more than `least`, its place and its slopes: of the first these come along, as most steps end
    there."""
    for turn, (place, tried) in enumerate(tries.items()):
        runs = _passes(case, tried, numbers if turn == 0 else ())
        if runs is None or _worth(tried, runs, numbers) <= least:
            continue
        sloped = runs if turn == 0 else _passes(case, tried, numbers)
        return None if sloped is None else (place, tried, sloped)
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


def _damped(information: Array, damping: float) -> Array:
    """Levenberg's and Marquardt's: steps become shorter, and each number goes more by its own slope."""
    return information + damping * np.diag(np.diag(information))


def _moved(hypothesis: Hypothesis, numbers: Sequence[Number], step: Array) -> Hypothesis:
    """A step in variances, which `_kept` has kept near, of numbers in decades."""
    decades = np.log1p(TWICE * step) / TWICE
    for number, change in zip(numbers, decades.tolist(), strict=True):
        hypothesis = number.put(hypothesis, number.of(hypothesis) + change) if change else hypothesis
    return hypothesis


def _kept(step: Array) -> Array:
    """A step straight in the variances, where one of them makes all innovations it ends at the top; none goes further than FURTHEST."""
    least, most = (np.expm1(TWICE * by) / TWICE for by in (-FURTHEST, FURTHEST))
    return np.asarray(np.clip(step, least, most))


def _linear(hypothesis: Hypothesis, runs: Sequence[Pass], numbers: Sequence[Number]) -> tuple[Array, Array]:
    """g and I of (2) by the numbers, with what is known of them."""
    known = np.array([number.known[1] for number in numbers])
    away = np.array([number.away(hypothesis) for number in numbers])
    return sum(run.score for run in runs) - away / known, sum(run.information for run in runs) + np.diag(1.0 / known**2)
