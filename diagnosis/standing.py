"""Whether a gap stands: a small one must be explained by evidence, and what explains any must predict better."""

from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.holdout import surely_better
from diagnosis.decide.weighing import named
from diagnosis.decisions import decided, held_against
from diagnosis.result import Judged, Seen
from diagnosis.search.beam import Search
from diagnosis.search.retune import Retune
from diagnosis.seeing import false_alarm
from diagnosis.validate.fitted_logs import readings_of


def confirmed_by(seen: Seen, found: Search, beyond: Retune | None) -> Seen:
    """A small gap also needs effects of sure size, or parameters, that explain it: without a gap, evidence of x nats has a chance of
    exp(-x) at most, and the larger of both chances is that of so large a gap without one."""
    detection = seen.detection
    small = detection.largest <= decisions.PLAIN_TO_SEE
    size = decided(
        "plain_to_see", "logs", detection.largest, decisions.PLAIN_TO_SEE, "must be explained" if small else "a gap"
    )
    if not small:
        return seen.because(size)
    explained = [entry.evidence for entry in found.fitted if entry.effects and found.sure]
    explained += [] if beyond is None else [beyond.score]
    best = max(explained, default=found.nominal.evidence) - found.nominal.evidence
    p = max(detection.p, float(np.exp(-max(best, 0.0))))
    return replace(seen.because(size, false_alarm("what explains it", p)), detection=replace(detection, p=p))


def of_consequence(seen: Seen, judged: Judged) -> tuple[Seen, bool]:
    """Whether what explains a gap predicts the logs better than the plain plant with its parameters moved: by what matters, and a small gap
    by more than chance, as a gain of x nats has a chance of exp(-x) at most; or surely those that were not fitted.

    A plant that had to move a parameter beyond its spread is none that is as stated, however well it then predicts.
    """
    small, ahead_nats = seen.detection.largest <= decisions.PLAIN_TO_SEE, judged.weighed.ahead_nats
    furthest = float(np.max(np.abs(seen.retuned.fit.hypothesis.theta), initial=0.0))
    beyond = seen.detection.moved and furthest > decisions.FREE_SPREAD
    if beyond or (ahead_nats is None and not small):
        return seen, True
    least = float(decisions.MATTERS) * readings_of(seen.case)
    least = max(least, -float(np.log(decisions.ALARM))) if small else least
    matters = ahead_nats is not None and ahead_nats >= least
    outcome = "matters" if matters else "no gap: too small to matter"
    rule = held_against("matters", named(judged.weighed), ahead_nats or 0.0, least, "nats", outcome)
    surely, told = (
        (matters, ()) if matters or judged.holdout is None else surely_better(judged.holdout, judged.weighed.fitted)
    )
    return seen.because(rule, *told), surely
