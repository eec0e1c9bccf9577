"""What logs that were not fitted say: whether a re-tune, an unknown effect and what is named hold there."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.case import Case
from diagnosis.fit import unfitted
from diagnosis.hypothesis import nothing_supposed
from diagnosis.retune import Retune
from diagnosis.shrinkage import Predicted, error, predict_all, shrinkage
from diagnosis.trial import Tried, evidence
from diagnosis.unrest import FIRST_UNREST
from diagnosis.weigh import Weighed, confirmed
from records.diagnosis import Shrinkage
from records.table import ControllerTable

LITTLE = 0.1  # share of the gap's evidence that may be left beside a hypothesis for the hold-out to overrule an unknown effect,
NEARLY_ALL = 0.85  # and the share of the error that must then be gone there
HELPS = 0.995  # of the hold-out's error that must be left at most for an effect to be added


@dataclass(frozen=True, eq=False)
class Holdout:
    """Logs that were not fitted, their names, the controller that flew each, None where it is not at hand, and the plant without effects
    that they are judged against: `base`, re-tuned within its spread, or as stated where that predicts better, as `notes` then tell."""

    case: Case
    names: Sequence[str]
    tables: Sequence[ControllerTable | None]
    base: Tried
    notes: tuple[str, ...] = ()

    def predicted(self, chosen: Tried) -> tuple[Predicted, ...]:
        """Predictions by the plant as stated, by `base`, and with what was `chosen`."""
        stated = replace(nothing_supposed(self.case, FIRST_UNREST), unrest=self.base.fit.supposed.unrest)
        bars = {"nominal": stated, "before": self.base.fit.supposed, "after": chosen.fit.supposed}
        return predict_all(self.case, self.names, bars)

    def shrinkage(self, predicted: Sequence[Predicted]) -> Shrinkage:
        """How far the gap shrinks in these predictions."""
        return shrinkage(self.case, predicted, self.tables)


def holdout_of(
    case: Case, names: Sequence[str], tables: Sequence[ControllerTable | None], fitted: Case, retuned: Tried
) -> Holdout:
    """The logs of `case` with what judges them; `retuned` is the plant as the `fitted` logs have it."""
    trial = Holdout(case, names, tables, retuned)
    predicted = trial.predicted(retuned)
    stated, before = (error(case, predicted, bar) for bar in ("nominal", "before"))
    if not 0.0 < stated < HELPS * before:  # a plant that predicts no row has no error
        return trial
    found = unfitted(fitted, retuned.fit.supposed.unrest)
    if found is None:
        return trial
    further = 100.0 * (float(np.sqrt(before / stated)) - 1.0)
    told = f"re-tuned within its spread the plant predicts the hold-out {further:.2g} % worse than as stated"
    return replace(trial, base=Tried((), found, evidence(found)), notes=(f"{told}, so its parameters stay as stated",))


def overruled(holdout: Holdout, weighed: Weighed, stated: Tried, left: float) -> Weighed:
    """What the hold-out says of an unknown effect: real rigs always leave a little that no form explains, beside what was found."""
    if not weighed.tried or weighed.unknown < weighed.probabilities[0]:
        return weighed
    first = weighed.tried[0]
    if left > LITTLE * (first.evidence - stated.evidence):
        return weighed
    gone = holdout.shrinkage(holdout.predicted(first)).fraction
    return weighed if gone is None or gone < NEARLY_ALL else confirmed(weighed, 1.0 - gone)


def worse(holdout: Holdout, weighed: Weighed) -> float:
    """How many times as large the hold-out's mean square error is with what is named as without; 0 for no name."""
    if not weighed.tried or weighed.probabilities[0] < weighed.unknown:
        return 0.0
    predicted = holdout.predicted(weighed.tried[0])
    return error(holdout.case, predicted, "after") / _without(holdout, predicted)


def helpful(holdout: Holdout, first: Tried) -> Tried:
    """What is to be added if it lowers the hold-out's error, else the plant without it."""
    predicted = holdout.predicted(first)
    helps = error(holdout.case, predicted, "after") < HELPS * _without(holdout, predicted)
    return first if helps else holdout.base


def likeliest(weighed: Weighed, stated: Tried, beyond: Retune | None) -> Tried:
    """The most probable hypothesis or re-tune if it beats an unknown effect, else the plant as `stated`."""
    if weighed.tried and sum(weighed.probabilities) > max(weighed.unknown, weighed.retune):
        return weighed.tried[0]
    return beyond.tried if beyond is not None and weighed.retune > weighed.unknown else stated


def _without(holdout: Holdout, predicted: Sequence[Predicted]) -> float:
    """The hold-out's error without an effect, as stated or re-tuned, whichever is less; a plant that predicts no row does not count."""
    errors = [error(holdout.case, predicted, bar) for bar in ("nominal", "before")]
    return min((value for value in errors if value > 0.0), default=float("inf"))
