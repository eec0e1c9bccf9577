"""Whether a gap matters, and each effect of a name: some thousand rows make any small thing certain, and what changes no prediction is
nothing to an engineer."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed
from diagnosis.decisions import decided
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


def without_idle(
    logs: FittedLogs, weighed: Weighed, tried: Sequence[FittedHypothesis]
) -> tuple[Weighed, tuple[Decision, ...]]:
    """What was weighed, without hypotheses one of whose effects predicts the logs no better than the likeliest of all that were `tried`
    without it; and the rules.

    What such an effect gains in nats it gains of the noise: it says nothing of what it stands beside, so those without it are compared by
    their own evidence, the names together as probable as before.
    """
    shares, whole = dict(zip(weighed.fitted, weighed.probabilities, strict=True)), sum(weighed.probabilities)
    asked, rules = set[FittedHypothesis](), list[Decision]()
    while (entry := _next(shares, asked)) is not None:
        asked.add(entry)
        fewer = _one_less(entry, tried)
        if fewer is None:
            continue
        gain = logs.gain(entry.fit.hypothesis, fewer.fit.hypothesis)
        left = " + ".join(sorted(set(entry.effects) - set(fewer.effects)))
        idle = gain < decisions.MATTERS
        outcome = f"{left} is left out" if idle else f"{left} matters"
        rules.append(decided("each_matters", " + ".join(entry.effects), gain, decisions.MATTERS, outcome))
        if idle:
            shares = _spread_over(shares, entry, fewer, whole)
    ranked = sorted(shares, key=lambda entry: -shares[entry])
    return replace(weighed, fitted=tuple(ranked), probabilities=tuple(shares[one] for one in ranked)), tuple(rules)


def _next(shares: Mapping[FittedHypothesis, float], asked: Set[FittedHypothesis]) -> FittedHypothesis | None:
    """The most probable that was not asked yet; None where all others hardly count."""
    likely = (one for one in shares if one not in asked and shares[one] >= decisions.LEAST_PREFERRED)
    return max(likely, key=lambda one: shares[one], default=None)


def _spread_over(
    shares: Mapping[FittedHypothesis, float], idle: FittedHypothesis, fewer: FittedHypothesis, whole: float
) -> dict[FittedHypothesis, float]:
    """The shares of all others, together as large as all were; `fewer` has it all where none of them counts."""
    kept = {one: share for one, share in shares.items() if one is not idle}
    rest = sum(kept.values())
    return {one: whole / rest * share for one, share in kept.items()} if rest > 0.0 else {fewer: whole}


def _one_less(entry: FittedHypothesis, tried: Sequence[FittedHypothesis]) -> FittedHypothesis | None:
    """The likeliest that was tried with all effects but one of it; None of a single effect."""
    fewer = [
        other
        for other in tried
        if len(other.effects) == len(entry.effects) - 1 > 0 and set(other.effects) < set(entry.effects)
    ]
    return max(fewer, key=lambda other: other.evidence, default=None)
