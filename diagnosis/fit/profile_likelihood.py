"""Line searches in the log likelihood, where slopes do not lead: what a number's values make of the logs, and the likeliest.

(1)  l(x) = max over n of ln L(x, n)

is the profile likelihood of a number x beside nuisances n (Pawitan 2001, section 3.4). Which nuisances are held and which follow x is the
caller's: it gives hypotheses, or a function `at` from x to a `Point`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.fit.gauss_newton import likelihood_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from jobs.thread_map import thread_map

MOST_STEPS = 12
LITTLE_PROMISED = 0.1  # nats
AGAIN_AS_FAR = 0.7  # of the way that all numbers went together, at first


@dataclass(frozen=True, eq=False)
class Number:
    """A number that a hypothesis has, its log10 where it is a noise's: where it is, a hypothesis with another, and the step, in its own
    unit, in which it is looked for."""

    of: Callable[[Hypothesis], float]
    put: Callable[[Hypothesis, float], Hypothesis]
    step: float


@dataclass(frozen=True, eq=False)
class Point:
    """A value x of a number, the hypothesis there, and its log likelihood in nats, -inf where the filter left all bounds."""

    x: float
    hypothesis: Hypothesis
    value: float


def likelihoods(case: Case, hypotheses: Sequence[Hypothesis]) -> list[float]:
    """The log likelihood of each, -inf where the filter left all bounds."""
    return thread_map(lambda hypothesis: likelihood_of(case, hypothesis), hypotheses)


def likeliest(case: Case, hypotheses: Sequence[Hypothesis]) -> tuple[Hypothesis, float]:
    """The likeliest of some hypotheses, the first of those alike, with its log likelihood."""
    values = likelihoods(case, hypotheses)
    best = int(np.argmax(values))
    return hypotheses[best], values[best]


def by_parabola(at: Callable[[float], Point], middle: Point, step: float, most_steps: int, least_gain: float) -> Point:
    """Uphill from `middle` in equal steps, then the top of the parabola through the last three points.

    (2)  x_top = x + step (l_- - l_+) / (2 (l_- - 2 l + l_+)),   higher than l by (l_- - l_+)^2 / (8 |l_- - 2 l + l_+|)

    It is only asked for where it promises `least_gain` nats.
    """
    below, above = at(middle.x - step), at(middle.x + step)
    for _ in range(most_steps):
        if below.value <= middle.value >= above.value:
            break
        if below.value > above.value:
            below, middle, above = at(below.x - step), below, middle
        else:
            below, middle, above = middle, above, at(above.x + step)
    bend = below.value - 2.0 * middle.value + above.value
    if not (np.isfinite(bend) and bend < 0.0) or (below.value - above.value) ** 2 < -8.0 * bend * least_gain:
        return middle
    top = at(middle.x + 0.5 * step * (below.value - above.value) / bend)
    return top if top.value > middle.value else middle


def along(case: Case, hypothesis: Hypothesis, value: float, number: Number) -> tuple[Hypothesis, float]:
    """The likeliest of one number, all others held, and its log likelihood; `value` is that of the hypothesis."""

    def at(x: float) -> Point:
        there = number.put(hypothesis, x)
        return Point(x, there, likelihood_of(case, there))

    found = by_parabola(at, Point(number.of(hypothesis), hypothesis, value), number.step, MOST_STEPS, LITTLE_PROMISED)
    return found.hypothesis, found.value


def along_each(case: Case, hypothesis: Hypothesis, value: float, numbers: Sequence[Number]) -> tuple[Hypothesis, float]:
    """The likeliest of each number in turn, and then along the way that all went together (Hooke and Jeeves 1961): two numbers that do the
    same part of the noise give way to each other by little a turn."""
    begun = [number.of(hypothesis) for number in numbers]
    for number in numbers:
        hypothesis, value = along(case, hypothesis, value, number)
    ended = [number.of(hypothesis) for number in numbers]
    if sum(x != y for x, y in zip(begun, ended, strict=True)) < 2:
        return hypothesis, value

    def put(hypothesis: Hypothesis, share: float) -> Hypothesis:
        for number, x, y in zip(numbers, begun, ended, strict=True):
            hypothesis = number.put(hypothesis, y + share * (y - x))
        return hypothesis

    return along(case, hypothesis, value, Number(lambda _: 0.0, put, AGAIN_AS_FAR))
