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

Changed = Callable[[Hypothesis, float], Hypothesis]
MOST_STEPS = 12
LITTLE_PROMISED = 0.1  # nats


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


def along(case: Case, start: Point, changed: Changed, step: float) -> tuple[Hypothesis, float]:
    """The likeliest of one number, all others held, and its log likelihood."""

    def at(x: float) -> Point:
        there = changed(start.hypothesis, x)
        return Point(x, there, likelihood_of(case, there))

    found = by_parabola(at, start, step, MOST_STEPS, LITTLE_PROMISED)
    return found.hypothesis, found.value


def by_folds(at: Callable[[float], Point], start: Point, fold: float, low: float, high: float) -> Point:
    """Uphill from a positive number by folds, upwards first, else downwards, strictly between `low` and `high`."""
    best = start
    for factor in (fold, 1.0 / fold):
        while low < best.x * factor < high:
            further = at(best.x * factor)
            if further.value <= best.value:
                break
            best = further
        if best is not start:
            break
    return best
