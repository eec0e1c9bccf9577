"""Whether a gap that was explained stands: what explains it must be likely enough, hold on logs that were not fitted, and matter."""

from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.consequence import consequence
from diagnosis.decide.holdout import surely_better
from diagnosis.decide.weighing import Weighed
from diagnosis.decisions import decided, held_against
from diagnosis.result import Judged, Seen
from diagnosis.search.beam import Search
from diagnosis.search.retune import Retune
from diagnosis.seeing import false_alarm


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
    """Whether anything that was found changes what a model predicts, of the logs or surely of those that were not fitted.

    It is asked against the plain plant with its parameters moved; one that had to move them further than its file allows is no plant that
    is as stated, however well it then predicts.
    """
    weighed = judged.weighed
    if seen.detection.moved or weighed.retune > max(weighed.probabilities, default=0.0):
        return seen, True
    tried, shares = list(weighed.fitted), list(weighed.probabilities)
    if judged.beyond is not None:
        tried, shares = [*tried, judged.beyond.fitted], [*shares, weighed.retune]
    rules = consequence(seen.case, seen.retuned, tried, shares)
    if all(rule.value is None or rule.value >= decisions.MATTERS for rule in rules):
        return seen.because(*rules), True
    surely, told = (False, ()) if judged.holdout is None else surely_better(judged.holdout, weighed.fitted)
    return seen.because(*rules, *told), surely


def borne_out(seen: Seen, weighed: Weighed) -> tuple[Seen, bool]:
    """Whether a gap stands: a small one that is not sure does not whose explanations do not hold, be it on the hold-out; a name that may
    be right in part is none for it. Its chance stays what it is."""
    unsure = seen.detection.largest <= decisions.PLAIN_TO_SEE and seen.detection.p > decisions.SURE_GAP
    named, against = max(weighed.retune, *weighed.probabilities, 0.0), weighed.unknown + weighed.partly
    stands = not (unsure and against > named)
    outcome = "no gap: nothing that was found holds" if not stands else "stands"
    rule = held_against("borne_out", "what explains it", named, against, "probability", outcome)
    return (seen.because(rule) if unsure else seen), stands
