"""What a name predicts better: some thousand rows make any small thing certain, what changes no prediction is nothing to an engineer."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.weighing import Tried, Weighed, beyond_spread
from diagnosis.decisions import held_against
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.validate.fitted_logs import FittedLogs
from jobs.thread_map import thread_map
from records.reasons import Decision

MOST_FORESEEN = 16  # explanations, by evidence: of 58 right names one had a lower rank
TOLD_FROM = 0.02  # probability: of less probable ones no rule is told


def foreseen(logs: FittedLogs, tried: Tried) -> dict[FittedHypothesis, float]:
    """Nats by which the likeliest of what was tried, the same with one effect less, and parameters beyond their spread predict the logs
    better than the plant alone, over horizons from a row to a second (validate/score.py), in nats of all readings that share no error
    (`FittedLogs.readings`).

    What an effect gains in evidence alone it gains of the noise, row by row, or of what the others' forms are a little off. Those with
    less evidence than the MOST_FORESEEN most evident are not asked.
    """
    asked = sorted(tried.named, key=lambda entry: -entry.evidence)[:MOST_FORESEEN]
    fewer = [other for entry in asked for other in _one_less(entry, tried.named)]
    asked = list(dict.fromkeys([*asked, *fewer, *([] if tried.beyond is None else [tried.beyond])]))
    plain, readings = tried.nominal.fit.hypothesis, logs.readings
    gains = thread_map(lambda entry: logs.gain(entry.fit.hypothesis, plain), asked)
    return {entry: readings * gain for entry, gain in zip(asked, gains, strict=True)}


def without_idle(tried: Tried, ahead: Mapping[FittedHypothesis, float]) -> tuple[Tried, tuple[Decision, ...]]:
    """What was tried, without hypotheses one of whose effects does less than FORMS_OFF of what they predict better, beside the same
    without it; and the rules. What parameters beyond their spread cost counts: where these leave it to take an effect's part, it is not
    idle.

    The same without an idle effect keeps the evidence that it has beside it: what that explains is there whatever its name.
    """
    idle = [
        (entry, fewer, gain, least)
        for entry in sorted(tried.named, key=lambda entry: -len(entry.effects))
        for fewer in (_one_less(entry, ahead) if entry in ahead else ())
        if (gain := ahead[entry] - beyond_spread(entry) - ahead[fewer] + beyond_spread(fewer))
        < (least := float(decisions.FORMS_OFF) * max(ahead[entry], 0.0))
    ]
    rules = tuple(
        held_against(
            "each_matters",
            " + ".join(entry.effects),
            gain,
            least,
            "nats",
            f"{' + '.join(sorted(set(entry.effects) - set(fewer.effects)))} is left out",
        )
        for entry, fewer, gain, least in idle
    )
    beside = dict(tried.beside)
    for entry, fewer, *_ in idle:  # triples first, so that what a pair has beside an idle effect reaches a single one
        beside[fewer] = max(beside.get(fewer, -np.inf), beside.get(entry, -np.inf), entry.evidence)
    gone = {entry for entry, *_ in idle}
    return replace(tried, named=tuple(entry for entry in tried.named if entry not in gone), beside=beside), rules


def _one_less(entry: FittedHypothesis, asked: Iterable[FittedHypothesis]) -> list[FittedHypothesis]:
    """What was asked with all effects but one of it; nothing of a single effect."""
    return [
        other
        for other in asked
        if len(other.effects) == len(entry.effects) - 1 > 0 and set(other.effects) < set(entry.effects)
    ]


def foreseen_rules(foretold: Mapping[FittedHypothesis, float], weighed: Weighed) -> tuple[Decision, ...]:
    """The records of what the likely ones predict better, beside the likeliest."""
    shares = zip(weighed.fitted, weighed.probabilities, strict=True)
    likely = [entry for entry, p in shares if p >= TOLD_FROM and entry in foretold]
    if not likely:
        return ()
    first = foretold[likely[0]]
    return tuple(
        held_against(
            "foresees",
            " + ".join(entry.effects),
            foretold[entry],
            first,
            "nats",
            "likelier" if foretold[entry] > first else "no likelier",
        )
        for entry in likely
    )
