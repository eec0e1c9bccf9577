"""The likelihood where slopes do not lead: of some hypotheses, each, and the likeliest."""

from collections.abc import Sequence

import numpy as np

from diagnosis.fit.gauss_newton import likelihood_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from jobs.thread_map import thread_map


def likelihoods(case: Case, hypotheses: Sequence[Hypothesis]) -> list[float]:
    """The log likelihood of each, -inf where the filter left all bounds."""
    return thread_map(lambda hypothesis: likelihood_of(case, hypothesis), hypotheses)


def likeliest(case: Case, hypotheses: Sequence[Hypothesis]) -> tuple[Hypothesis, float]:
    """The likeliest of some hypotheses, the first of those alike, with its log likelihood."""
    values = likelihoods(case, hypotheses)
    best = int(np.argmax(values))
    return hypotheses[best], values[best]
