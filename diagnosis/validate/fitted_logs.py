"""How hypotheses predict the logs that they were fitted to: by how many nats a reading one does so better than another."""

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
class FittedLogs:
    """The logs of a case, and the errors and gains of what was judged on them already."""

    case: Case
    judged: dict[Hypothesis, Errors] = field(default_factory=dict)
    better: dict[tuple[Hypothesis, Hypothesis], Errors] = field(default_factory=dict)

    def gain(self, one: Hypothesis, other: Hypothesis) -> float:
        """By how many nats a reading `one` predicts these logs better than `other` (score.py), each as `errors_beside` the other."""
        return score(self.errors_beside(one, other), self.errors_beside(other, one)).gain

    def errors_beside(self, hypothesis: Hypothesis, other: Hypothesis) -> Errors:
        """The errors of a hypothesis under its own noise or under that of the other, whichever predicts better: noise is not what is
        asked."""
        if (hypothesis, other) not in self.better:
            self.better[hypothesis, other] = self._better(hypothesis, other)
        return self.better[hypothesis, other]

    @property
    def readings(self) -> int:
        """See `readings_of`."""
        return readings_of(self.case)

    def errors(self, hypothesis: Hypothesis) -> Errors:
        """The errors of its predictions."""
        if hypothesis not in self.judged:
            self.judged[hypothesis] = errors_of(self.case, hypothesis, self._read)
        return self.judged[hypothesis]

    def _better(self, hypothesis: Hypothesis, other: Hypothesis) -> Errors:
        own, noisy = self.errors(hypothesis), errors_of(self.case, as_noisy(self.case, hypothesis, other), self._read)
        return noisy if score(noisy, own).gain > 0.0 else own

    def _read(self, hypothesis: Hypothesis) -> list[Array]:
        return [predictions(self.case, flight, hypothesis) for flight in self.case.flights]


def readings_of(case: Case) -> int:
    """How many readings of the logs share no error: one in each window of a second; LEAST_APART in short logs: of plants whose errors pass
    sooner."""
    return max(sum(len(windows(flight.log.t_s)) for flight in case.flights), decisions.LEAST_APART)
