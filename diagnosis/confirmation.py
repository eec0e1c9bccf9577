"""Whether a gap stands: a small one must be explained by evidence, and what explains any must predict better, be it noise that does."""

from dataclasses import replace
from enum import IntEnum

import numpy as np

from diagnosis import decisions
from diagnosis.decide.holdout import NATS
from diagnosis.decide.weighing import named
from diagnosis.decisions import decided, held_against
from diagnosis.result import Exit, Judged, Seen
from diagnosis.screening import false_alarm
from diagnosis.search.beam import Search
from diagnosis.search.draughts import gust_shares
from diagnosis.search.retune import Retune
from diagnosis.validate.fitted_logs import FittedLogs
from records.reasons import Decision, Note


class Consequence(IntEnum):
    """Whether something matters to predictions."""

    NONE = 0
    PERHAPS = 1
    SURE = 2


_OUTCOMES = ("too small to matter", "may matter, not surely", "matters")
_EXITS = {Consequence.NONE: Exit.TOO_SMALL, Consequence.PERHAPS: Exit.TOO_UNSURE}


def is_noise(noisy: Seen, seen: Seen, found: Search) -> tuple[Seen, bool]:
    """Whether the plant alone with its noise, `noisy`, explains the logs as well as the likeliest name that was sought without: then it is
    no likelier beside noise of its own, nor does it predict the logs better, and a torque that comes and goes is more than is usual."""
    names = [entry for entry in found.fitted if entry.effects]
    largest = max(gust_shares(noisy.case, noisy.retuned.fit.hypothesis).values(), default=0.0)
    if seen.retuned is noisy.retuned or not names or largest < decisions.USUAL_GUST:
        return seen, False
    of, gain = " + ".join(names[0].effects), names[0].evidence - noisy.retuned.evidence
    likelier = gain > decisions.TAKEN_IN
    rule = decided("more_than_noise", of, gain, decisions.TAKEN_IN, "stands" if likelier else "as likely as noise")
    if likelier:
        return seen.because(rule), False
    ahead = FittedLogs(seen.case).gain(names[0].fit.hypothesis, noisy.retuned.fit.hypothesis)
    better = ahead >= decisions.MATTERS
    further = decided("foresees_more_than_noise", of, ahead, decisions.MATTERS, "stands" if better else "noise")
    return seen.because(rule, further), not better


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


def of_consequence(seen: Seen, judged: Judged) -> tuple[Seen, Exit | None]:
    """By which exit a gap leaves whose explanation predicts the logs no better than the plain plant with its parameters moved: by what
    matters, and a small gap by more than chance, as a gain of x nats has a chance of exp(-x) at most; or surely those that were not
    fitted. None where it stands. What may matter, but not surely, is not said to be nothing, be it what a free curve stands for.

    A plant that had to move a parameter beyond its spread is none that is as stated, however well it then predicts.
    """
    small, ahead_nats = seen.detection.largest <= decisions.PLAIN_TO_SEE, judged.weighed.ahead_nats
    furthest = float(np.max(np.abs(seen.retuned.fit.hypothesis.theta), initial=0.0))
    beyond = seen.detection.moved and furthest > decisions.BEYOND_CHANCE
    if beyond or (ahead_nats is None and not small):
        return seen, None
    worth = float(decisions.MATTERS) * FittedLogs(seen.case).readings
    surely = max(worth, -float(np.log(decisions.ALARM))) if small else worth
    told, rule = _consequence("matters", named(judged.weighed), ahead_nats or 0.0, worth, surely, "nats")
    seen = seen.because(rule)
    if told is Consequence.NONE and judged.curve is not None:
        of = judged.curve.curve.class_text
        nameless, rule = _consequence("curve_matters", of, judged.curve.ahead_nats, worth, surely, "nats")
        told, seen = Consequence.PERHAPS if nameless is Consequence.SURE else told, seen.because(rule)
    names = judged.weighed.fitted and not judged.weighed.nameless
    if told is not Consequence.SURE and judged.holdout is not None and names:
        score = judged.holdout.score(judged.weighed.fitted[0].fit.hypothesis)
        worth, surely = float(decisions.MATTERS), decisions.SURELY * score.sd
        there, rule = _consequence("matters_elsewhere", named(judged.weighed), score.gain, worth, surely, NATS)
        told, seen = max(told, there), seen.because(rule)
    return seen, _EXITS.get(told)


def may_be_missing(judged: Judged) -> tuple[Note, ...]:
    """What would explain a gap that does not surely matter: the likeliest name, and what a free curve stands for where that predicts
    better than what explains does in the mean."""
    weighed, curve = judged.weighed, judged.curve
    found = [(named(weighed), weighed.probabilities[0])] if weighed.fitted else []
    if curve is not None and curve.ahead_nats > (weighed.ahead_nats or 0.0):
        found.append((curve.curve.class_text, weighed.unknown))
    return tuple(Note("may_be_missing", subject, {"probability": p}) for subject, p in found)


def _consequence(
    rule: str, of: str, gain: float, worth: float, surely: float, unit: str
) -> tuple[Consequence, Decision]:
    """What a gain of predictions comes to where less than `worth` is nothing, and less than `surely` may be chance; and the rule."""
    least = max(worth, surely)
    told = Consequence((gain >= worth) + (gain >= least))
    return told, held_against(rule, of, gain, least, unit, _OUTCOMES[told])
