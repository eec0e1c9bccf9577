"""The likelihood where slopes do not lead: of some hypotheses, each, and the likeliest."""

from collections.abc import Sequence

import numpy as np

from diagnosis.fit.likelihood import likelihood_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from jobs.thread_map import thread_map
from sim.effect import EffectParameter

REACHES = (0.01, 0.03, 0.1, 0.3)  # of a number's range, over which the likelihood is asked how it falls
A_DEVIATION_NATS = 0.5  # by which it falls over a standard deviation


def likelihoods(case: Case, hypotheses: Sequence[Hypothesis]) -> list[float]:
    """The log likelihood of each, -inf where the filter left all bounds."""
    return thread_map(lambda hypothesis: likelihood_of(case, hypothesis), hypotheses)


def likeliest(case: Case, hypotheses: Sequence[Hypothesis]) -> tuple[Hypothesis, float]:
    """The likeliest of some hypotheses, the first of those alike, with its log likelihood."""
    values = likelihoods(case, hypotheses)
    best = int(np.argmax(values))
    return hypotheses[best], values[best]


def known_to(case: Case, hypothesis: Hypothesis, name: str, parameter: EffectParameter) -> float:
    """What is known of an effect's number, in its unit: the least of REACHES over which the likelihood falls by A_DEVIATION_NATS to each
    side; its whole range where it falls by less."""
    at, width = hypothesis.effects[name][parameter.symbol], parameter.upper - parameter.lower
    (there,) = likelihoods(case, [hypothesis])

    def falls(reach: float) -> bool:
        beside = (at - reach * width, at + reach * width)
        inside = [value for value in beside if parameter.lower <= value <= parameter.upper]
        values = likelihoods(case, [hypothesis.with_value(name, parameter.symbol, value) for value in inside])
        return all(value < there - A_DEVIATION_NATS for value in values)

    return width * next(filter(falls, REACHES), 1.0)
