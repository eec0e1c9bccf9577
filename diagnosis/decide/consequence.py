"""Whether a gap matters, and each effect of a name: some thousand rows make any small thing certain, and what changes no prediction is
nothing to an engineer."""

from collections.abc import Sequence, Set

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.weighing import Tried, Weighed, beyond_spread, weigh
from diagnosis.decisions import decided, held_against
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from diagnosis.validate.fitted_logs import FittedLogs
from diagnosis.validate.score import score
from jobs.thread_map import thread_map
from records.reasons import Decision

Array = NDArray[np.float64]
ASKED = 3  # of the most probable explanations
LEAST_WEIGHT = 1e-6  # where the unknown is all, its rivals count alike


def consequence(
    case: Case, plain: FittedHypothesis, tried: Sequence[FittedHypothesis], shares: Sequence[float]
) -> tuple[Decision, ...]:
    """The rule that asks by how many nats a reading what was `tried` predicts the logs that it was fitted to better than the `plain` plant
    (validate/score.py), in the mean by their probabilities `shares`; none where nothing was tried."""
    asked = sorted(zip(shares, tried, strict=True), key=lambda entry: -entry[0])[:ASKED]
    if not asked:
        return ()
    logs = FittedLogs(case)
    own, *others = thread_map(lambda entry: logs.errors(entry.fit.hypothesis), [plain, *(entry for _, entry in asked)])
    weights = [max(share, LEAST_WEIGHT) for share, _ in asked]
    gain = float(np.average([score(other, own).gain for other in others], weights=weights))
    of = " + ".join(asked[0][1].effects) or "parameters"
    outcome = "matters" if gain >= decisions.MATTERS else "no gap: too small to matter"
    return (decided("matters", of, gain, decisions.MATTERS, outcome),)


def without_idle(logs: FittedLogs, tried: Tried) -> tuple[Tried, tuple[Decision, ...]]:
    """What was tried, without hypotheses one of whose effects predicts the logs hardly better than the likeliest of all without it; and the
    rules.

    What such an effect gains in nats it gains of the noise, or of what the others' forms are a little off: it says nothing of what it
    stands beside. Where the plant's parameters leave their spread to take an effect's part, it is not idle.
    """
    asked, idle, rules = set[FittedHypothesis](), set[FittedHypothesis](), list[Decision]()
    while (entry := _next(weigh(tried.without(idle)), asked)) is not None:
        asked.add(entry)
        fewer = _one_less(entry, tried.named)
        if fewer is None:
            continue
        rule, matters = _matters(logs, tried, entry, fewer)
        rules.append(rule)
        idle |= set() if matters else {entry}
    return tried.without(idle), tuple(rules)


def _matters(logs: FittedLogs, tried: Tried, entry: FittedHypothesis, fewer: FittedHypothesis) -> tuple[Decision, bool]:
    """The rule that asks whether the effect that a hypothesis has beside a `fewer` one is not idle, and its answer."""
    of, left = " + ".join(entry.effects), " + ".join(sorted(set(entry.effects) - set(fewer.effects)))
    bent = beyond_spread(fewer) - beyond_spread(entry)
    if bent > decisions.TAKEN_IN:
        return decided("parameters_instead", of, bent, decisions.TAKEN_IN, f"{left} matters"), True
    gain = logs.gain(entry.fit.hypothesis, fewer.fit.hypothesis)
    whole = logs.gain(entry.fit.hypothesis, tried.nominal.fit.hypothesis)
    least = max(float(decisions.MATTERS), decisions.FORMS_OFF * whole)
    outcome = f"{left} matters" if gain >= least else f"{left} is left out"
    return held_against("each_matters", of, gain, least, "nats a reading", outcome), gain >= least


def _next(weighed: Weighed, asked: Set[FittedHypothesis]) -> FittedHypothesis | None:
    """The most probable that was not asked yet; None where all others hardly count."""
    shares = zip(weighed.fitted, weighed.probabilities, strict=True)
    return next((one for one, p in shares if one not in asked and p >= decisions.LEAST_PREFERRED), None)


def _one_less(entry: FittedHypothesis, tried: Sequence[FittedHypothesis]) -> FittedHypothesis | None:
    """The likeliest that was tried with all effects but one of it; None of a single effect."""
    fewer = [
        other
        for other in tried
        if len(other.effects) == len(entry.effects) - 1 > 0 and set(other.effects) < set(entry.effects)
    ]
    return max(fewer, key=lambda other: other.evidence, default=None)
