"""Reasons to name nothing: logs that contradict each other, a plant that knows nothing of its logs, parameters that must be others'."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.contradiction import Contradiction, contradiction, parted_gain
from diagnosis.decide.weighing import Weighed
from diagnosis.detect.instants import is_event
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.search.beam import Search
from diagnosis.validate.misfit import ignorance

ROUNDS = 4  # of a fit to all logs together


@dataclass(frozen=True)
class Doubt:
    """Sentences that go with the diagnosis, and whether they forbid to name a cause."""

    sentences: tuple[str, ...]
    forbids: bool

    def applied(self, weighed: Weighed) -> Weighed:
        """The probabilities with what is doubted given to the unknown."""
        return (
            weighed
            if not self.forbids or weighed.unknown >= decisions.UNNAMED
            else weighed.with_unknown(decisions.UNNAMED)
        )


def doubt(case: Case, found: Search, weighed: Weighed, names: Sequence[str], worse: float) -> Doubt:
    """What speaks against the best hypothesis that the weighing does not know; `names` are those of the logs, `worse` how many times
    as large the hold-out's mean square error is with what would be named."""
    best = found.fitted[0]
    gain = best.evidence - found.nominal.evidence
    sentences, forbids = [], False
    apart = contradiction(case, best.fit)
    if apart is not None and apart.gain > max(decisions.CONTRADICTION, decisions.CONTRADICTION_SHARE * gain):
        apart = replace(apart, gain=min(apart.gain, parted_gain(case, best.fit)))
    if apart is not None and apart.gain > decisions.CONTRADICTION:
        sentences.append(_contradiction(apart, names))
        forbids = apart.gain > decisions.CONTRADICTION_SHARE * gain
    errors = ignorance(case, best.fit.hypothesis)
    if errors and min(errors.values()) > decisions.KNOWS_NOTHING:
        told = ", ".join(f"{name} {value:.2g}" for name, value in errors.items())
        sentences.append(
            "this plant does not fit these logs at all: whatever is added to it, its predictions over 1 s are no better than holding "
            f"the last reading (error over that of holding: {told}); check that they belong together, columns, signs and units"
        )
        forbids = True
    if worse > decisions.REFUTED and not any(
        is_event(case.library.effects[name]) for name in weighed.fitted[0].effects
    ):
        named = " + ".join(weighed.fitted[0].effects)
        sentences.append(
            f"the hold-out refutes {named}: with it, predictions are {np.sqrt(worse):.2f} times as far off as without"
        )
        forbids = True
    furthest = float(np.max(np.abs(best.fit.hypothesis.theta), initial=0.0))
    if furthest > decisions.ANOTHER_PLANT and weighed.unknown > 0.5:
        sentences.append(
            f"these may be logs of another plant: beside every effect a parameter stays {furthest:.0f} standard deviations from what "
            "the plant file states"
        )
    return Doubt(tuple(sentences), forbids)


def contradicting(case: Case, hypothesis: Hypothesis, names: Sequence[str]) -> tuple[str, ...]:
    """Which of logs that seem to be of the plant as `hypothesis`, without a gap, contradicts the others; nothing where none does."""
    together = fit(case, hypothesis, rounds=ROUNDS)
    apart = None if together is None else contradiction(case, together)
    if together is None or apart is None or apart.gain <= decisions.CONTRADICTION:
        return ()
    apart = replace(apart, gain=min(apart.gain, parted_gain(case, together)))
    return (_contradiction(apart, names),) if apart.gain > decisions.CONTRADICTION else ()


def _contradiction(apart: Contradiction, names: Sequence[str]) -> str:
    name = names[apart.index] if apart.index < len(names) else f"log {apart.index + 1}"
    moved = ", ".join(f"{what} {by:+.1f}" for what, by in apart.moved)
    return (
        f"these logs contradict each other: {name} would be {apart.gain:.0f} nats likelier with numbers of its own ({moved}, in units "
        "of their spread), so one plant in one state did not make them all; diagnose them apart"
    )
