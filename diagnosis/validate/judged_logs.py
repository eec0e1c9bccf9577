"""Logs, and what was predicted of them already: no hypothesis is run along them twice."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, as_noisy
from diagnosis.validate.prediction import predictions, windows
from diagnosis.validate.score import Errors, errors_of, score

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JudgedLogs:
    """The logs of a case, with the predictions and errors of each hypothesis that was asked for."""

    case: Case
    predicted: dict[Hypothesis, list[Array]] = field(default_factory=dict)
    judged: dict[Hypothesis, Errors] = field(default_factory=dict)

    def predictions(self, hypothesis: Hypothesis) -> list[Array]:
        """Those of each log, (rows, outputs)."""
        if hypothesis not in self.predicted:
            self.predicted[hypothesis] = [predictions(self.case, flight, hypothesis) for flight in self.case.flights]
        return self.predicted[hypothesis]

    def errors(self, hypothesis: Hypothesis) -> Errors:
        """The errors of its predictions."""
        if hypothesis not in self.judged:
            self.judged[hypothesis] = errors_of(self.case, hypothesis, self.predictions)
        return self.judged[hypothesis]

    def under_better_noise(self, hypothesis: Hypothesis, other: Hypothesis) -> Hypothesis:
        """A hypothesis under its own noise or under that of the other, whichever predicts better: noise is not what is asked."""
        noisy = as_noisy(self.case, hypothesis, other)
        return noisy if score(self.errors(noisy), self.errors(hypothesis)).gain > 0.0 else hypothesis

    @property
    def readings(self) -> int:
        """How many readings share no error: one in each window of a second; LEAST_APART in short logs: of plants whose errors pass
        sooner."""
        return max(
            sum(len(windows(flight.log.t_s, self.case.second_s)) for flight in self.case.flights), decisions.LEAST_APART
        )
