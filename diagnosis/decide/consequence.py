"""Whether a gap matters: some thousand rows make any small thing certain, and one that changes no prediction is none to an engineer."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decisions import decided
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.prediction import predictions
from diagnosis.validate.score import Errors, errors_of, score
from jobs.thread_map import thread_map
from records.reasons import Decision

Array = NDArray[np.float64]
ASKED = 3  # of the most probable explanations


def consequence(case: Case, plain: FittedHypothesis, tried: Sequence[FittedHypothesis]) -> tuple[Decision, ...]:
    """The rule that asks by how many nats a reading the best of what was `tried` predicts the logs that it was fitted to better than the
    `plain` plant (validate/score.py); none where nothing was tried."""
    if not tried:
        return ()

    def errors(entry: FittedHypothesis) -> Errors:
        return errors_of(case, entry.fit.hypothesis, lambda hypothesis: _all(case, hypothesis))

    own, *others = thread_map(errors, [plain, *tried[:ASKED]])
    gains = [score(other, own).gain for other in others]
    best = max(gains)
    of = " + ".join(tried[gains.index(best)].effects) or "parameters"
    outcome = "matters" if best >= decisions.MATTERS else "no gap: too small to matter"
    return (decided("matters", of, best, decisions.MATTERS, outcome),)


def _all(case: Case, hypothesis: Hypothesis) -> list[Array]:
    return [predictions(case, flight, hypothesis) for flight in case.flights]
