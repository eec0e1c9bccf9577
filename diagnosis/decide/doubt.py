"""Reasons to name nothing: logs that contradict each other, a plant that knows nothing of its logs, parameters that must be others'."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.contradiction import Contradiction, contradiction, parted_evidence, parted_gain
from diagnosis.decide.weighing import Weighed
from diagnosis.decisions import decided, held_against
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.search.beam import Search
from diagnosis.validate.misfit import ignorance
from records.reasons import Decision, Note

JOINT_ROUNDS = 4  # of a fit to all logs together
FORBIDS, TELLS, UNCHANGED = "no cause is named", "is told", "no objection"


@dataclass(frozen=True)
class Doubt:
    """Notes that go with the diagnosis, the rules that were asked, and whether they forbid to name a cause."""

    notes: tuple[Note, ...]
    decisions: tuple[Decision, ...]
    forbids: bool

    def applied(self, weighed: Weighed) -> Weighed:
        """The probabilities, all of it the unknown's where no cause may be named."""
        return weighed.without_names() if self.forbids else weighed


@dataclass(frozen=True)
class _Objection:
    """What one rule says: its record, its note where it has something to tell, and whether it forbids to name a cause."""

    decision: Decision
    note: Note | None = None
    forbids: bool = False


def doubt(case: Case, found: Search, weighed: Weighed, names: Sequence[str]) -> Doubt:
    """What speaks against the best hypothesis that the weighing does not know; `names` are those of the logs."""
    best = found.fitted[0]
    objections = (
        *_contradicted(case, best, found.nominal, names),
        *_unknowing(case, best),
        _of_another_plant(best, weighed),
    )
    notes = tuple(entry.note for entry in objections if entry.note is not None)
    return Doubt(notes, tuple(entry.decision for entry in objections), any(entry.forbids for entry in objections))


def contradicting(
    case: Case, hypothesis: Hypothesis, names: Sequence[str]
) -> tuple[tuple[Note, ...], tuple[Decision, ...]]:
    """Which of logs that seem to be of the plant as `hypothesis`, without a gap, contradicts the others, and the rule that says so;
    nothing where none does."""
    together = fit(case, hypothesis, rounds=JOINT_ROUNDS)
    apart = None if together is None else contradiction(case, together)
    if together is None or apart is None:
        return (), ()
    if apart.gain > decisions.CONTRADICTION:
        apart = replace(apart, gain=min(apart.gain, parted_gain(case, together)))
    told = apart.gain > decisions.CONTRADICTION
    decision = decided(
        "contradiction", _log(apart, names), apart.gain, decisions.CONTRADICTION, TELLS if told else UNCHANGED
    )
    return ((_contradiction(apart, names),) if told else ()), (decision,)


def _contradicted(
    case: Case, best: FittedHypothesis, nominal: FittedHypothesis, names: Sequence[str]
) -> Iterator[_Objection]:
    """Logs that want numbers of their own: told where they gain much by them, and a name is forbidden only where logs of as many plants
    without any effect are likelier than one plant with what was found."""
    apart = contradiction(case, best.fit)
    if apart is None:
        return
    if apart.gain > decisions.CONTRADICTION:
        apart = replace(apart, gain=min(apart.gain, parted_gain(case, best.fit)))
    told = apart.gain > decisions.CONTRADICTION
    yield _Objection(
        decided("contradiction", _log(apart, names), apart.gain, decisions.CONTRADICTION, TELLS if told else UNCHANGED),
        _contradiction(apart, names) if told else None,
    )
    if told:
        plants = parted_evidence(case, nominal.fit)
        forbids = plants > best.evidence
        yield _Objection(
            held_against(
                "as_many_plants",
                _log(apart, names),
                plants - nominal.evidence,
                best.evidence - nominal.evidence,
                "nats",
                FORBIDS if forbids else UNCHANGED,
            ),
            None,
            forbids,
        )


def _unknowing(case: Case, best: FittedHypothesis) -> Iterator[_Objection]:
    """A plant whose predictions are no better than holding the last reading."""
    errors = ignorance(case, best.fit.hypothesis)
    if errors:
        least = min(errors, key=lambda name: errors[name])
        limit = 1.0 - decisions.FORMS_OFF
        forbids = errors[least] > limit
        outcome = FORBIDS if forbids else UNCHANGED
        yield _Objection(
            held_against("knows_nothing", least, errors[least], limit, "ratio of errors", outcome),
            Note("knows_nothing", "plant", errors) if forbids else None,
            forbids,
        )


def _of_another_plant(best: FittedHypothesis, weighed: Weighed) -> _Objection:
    """A parameter that is far off beside every effect."""
    furthest = float(np.max(np.abs(best.fit.hypothesis.theta), initial=0.0))
    told = furthest > decisions.ANOTHER_PLANT and weighed.unknown > 0.5
    return _Objection(
        decided("another_plant", "plant", furthest, decisions.ANOTHER_PLANT, TELLS if told else UNCHANGED),
        Note("another_plant", "plant", {"deviations": furthest}) if told else None,
    )


def _log(apart: Contradiction, names: Sequence[str]) -> str:
    return names[apart.index] if apart.index < len(names) else f"log {apart.index + 1}"


def _contradiction(apart: Contradiction, names: Sequence[str]) -> Note:
    return Note("contradiction", _log(apart, names), {"gain_nats": apart.gain, "moved": dict(apart.moved)})
