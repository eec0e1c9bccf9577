"""How hypotheses predict the logs that they were fitted to: by how many nats a reading one does so better than another."""

from dataclasses import dataclass, field

from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.judged_logs import JudgedLogs
from diagnosis.validate.score import Errors, score


@dataclass(frozen=True, eq=False)
class FittedLogs(JudgedLogs):
    """The logs of a case, and what was found of each pair of hypotheses that was held against one another."""

    better: dict[tuple[Hypothesis, Hypothesis], Hypothesis] = field(default_factory=dict)

    def gain(self, one: Hypothesis, other: Hypothesis) -> float:
        """By how many nats a reading `one` predicts these logs better than `other` (score.py), each as `errors_beside` the other."""
        return score(self.errors_beside(one, other), self.errors_beside(other, one)).gain

    def errors_beside(self, hypothesis: Hypothesis, other: Hypothesis) -> Errors:
        """The errors of a hypothesis under its own noise or under that of the other, whichever predicts better."""
        if (hypothesis, other) not in self.better:
            self.better[hypothesis, other] = self.under_better_noise(hypothesis, other)
        return self.errors(self.better[hypothesis, other])
