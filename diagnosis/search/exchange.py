"""Effects of the best hypothesis exchanged for others, for their twins, or left out: what was fitted beside a wrong effect is tried where
the rest fits."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import shape_starts
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import LITTLE_NATS, fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.fit.profile_likelihood import likeliest
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.search.fitting import Proposal, at_its_place, keep_better, refined
from jobs.thread_map import thread_map

# Behind, under one noise, with what a further step promises: of thirty such twins noise set anew left none less than 180 nats behind.
LOST_NATS = 10.0 * decisions.PLAIN_TO_SEE


def exchange(case: Case, found: dict[frozenset[str], FittedHypothesis], worth: Set[str]) -> None:
    """Each effect of the best hypothesis in turn changed for others, while that makes it better.

    A right effect that was fitted beside a wrong one, or beside none, may have ended with its numbers and the plant's bent; from where
    the best hypothesis has them it ends well.
    """
    best = max(found.values(), key=lambda entry: entry.evidence)
    fewer = max((entry.evidence for entry in found.values() if len(entry.effects) < len(best.effects)), default=-np.inf)
    while len(best.effects) > 1 and best.evidence > fewer + decisions.TAKEN_IN:
        better = _exchanged(case, best, found, worth)
        if better is None:
            return
        best = found[frozenset(better.effects)] = better


def shrink(case: Case, found: dict[frozenset[str], FittedHypothesis]) -> None:
    """The best of the largest size once more without each effect in turn, where that was not found nearly as likely: what first showed
    beside a wrong effect may do without it (a floating search: Pudil, Novovicova and Kittler 1994)."""
    size = max(len(names) for names in found)
    largest = sorted((e for e in found.values() if len(e.effects) == size > 1), key=lambda entry: -entry.evidence)
    near = [entry for entry in largest if entry.evidence > largest[0].evidence - decisions.PLAIN_TO_SEE]
    fewer = {frozenset(entry.effects) - {name}: (entry, name) for entry in reversed(near) for name in entry.effects}
    wanted = {names: grown for names, grown in fewer.items() if not _is_near(found.get(names), grown[0])}
    starts = thread_map(lambda names: _shrunk(case, *wanted[names], found.get(names)), list(wanted))
    begun = [as_fitted(case, start) for start in starts if start is not None]
    keep_better(found, [*begun, *(entry for entry in thread_map(lambda fit: refined(case, fit), begun) if entry)])


def _shrunk(case: Case, fitted: FittedHypothesis, name: str, known: FittedHypothesis | None) -> Fit | None:
    """The hypothesis fitted without one of its effects, from where the others were, under the white noise that is left then; None where it
    begins by far less likely than what is `known` of it."""
    start = fit(case, with_process_noise(case, _without(fitted.fit.hypothesis, name)), rounds=0)
    if start is None or (known and start.log_likelihood < known.fit.log_likelihood - decisions.PLAIN_TO_SEE):
        return None
    return fit(case, start.hypothesis, rounds=4)


def fit_twins(
    case: Case, found: dict[frozenset[str], FittedHypothesis], first: FittedHypothesis
) -> list[FittedHypothesis]:
    """Effects that data hardly tell from one of the `first` hypothesis, fitted in its place and to the end, where they were not `found`
    nearly as likely: these, which are then found too.

    Score tests are taken under numbers and noise that are bent to take an effect's part: there only one of a few that are alike may
    promise much, and which noise is left beside it decides between them. And a search from far away may have led one to another hill.
    """
    starts = [start for name in first.effects for start in _twins_begun(case, found, first, name)]
    begun = [entry for entry in thread_map(lambda start: at_its_place(case, start), starts) if entry]
    near = [entry for entry in begun if not is_lost(entry.fit, first.fit)]
    ends = [entry for entry in thread_map(lambda entry: refined(case, entry), near) if entry]
    fresh: dict[frozenset[str], FittedHypothesis] = {}
    keep_better(fresh, [*begun, *ends])
    keep_better(found, fresh.values())
    return list(fresh.values())


def _twins_begun(
    case: Case, found: Mapping[frozenset[str], FittedHypothesis], first: FittedHypothesis, name: str
) -> list[Hypothesis]:
    """Where the twins of one effect begin, those that are not nearly as likely already: the likeliest of their starts in its place, as a
    linear problem knows nothing of where a spring rests."""
    rest = frozenset(first.effects) - {name}
    wanted = {twin for twin in twins_of(case.library, name) if not _is_near(found.get(rest | {twin}), first)}
    promised = {proposal.score_test.effect: proposal for proposal in _instead(case, first, name, wanted)}
    lack, starts = first.fit.hypothesis.lacks.get(name), []
    for twin in sorted(wanted):
        begun = [promised[twin].begun(case)] if twin in promised else []
        begun += _of_its_size(case, first, name, twin, begun)
        begun = [
            start.lacking(twin, lack and replace(lack, absent=case.library.effects[twin].absent)) for start in begun
        ]
        starts += [likeliest(case, begun)] if begun else []
    return [start for start, value in starts if value > -np.inf]


def is_lost(placed: Fit, first: Fit) -> bool:
    """Whether a twin, fitted in the place of what it is like, is so much less likely that no noise brings it near."""
    return first.log_likelihood - placed.log_likelihood - placed.promised > LOST_NATS


def _is_near(known: FittedHypothesis | None, first: FittedHypothesis) -> bool:
    return known is not None and known.evidence > first.evidence - decisions.PLAIN_TO_SEE


def _of_its_size(
    case: Case, first: FittedHypothesis, name: str, twin: str, promised: Sequence[Hypothesis]
) -> list[Hypothesis]:
    """A twin in the place of an effect with all shapes that it may have, as large as is `promised` or, in the same unit, as the effect."""
    own, other, hypothesis = case.library.effects[name].size, case.library.effects[twin], first.fit.hypothesis
    if other.is_event or other.swings or other.shown_in_readings:
        return []  # where it begins, or its size, the logs say
    sizes = [begun.effects[twin][other.size.symbol] for begun in promised]
    if other.size.unit == own.unit and not other.size.rough:
        away = hypothesis.effects[name][own.symbol] - (own.zero or 0.0)
        sizes.append(float(np.clip((other.size.zero or 0.0) + away, other.size.lower, other.size.upper)))
    rest = _without(hypothesis, name)
    return [
        rest.with_effects({**rest.effects, twin: {**other.absent, **shapes, other.size.symbol: size}})
        for size in sizes
        for shapes in shape_starts(other)
    ]


def twins_of(library: EffectLibrary, name: str) -> set[str]:
    """The candidates that data hardly tell from an effect, whichever of both says so."""
    own = library.effects[name].twins
    return {twin for twin in library.candidates if twin in own or name in library.effects[twin].twins}


def is_twin(library: EffectLibrary, one: FittedHypothesis, other: FittedHypothesis) -> bool:
    """Whether two hypotheses differ by one effect that data hardly tell from the other one."""
    mine, others = set(one.effects) - set(other.effects), set(other.effects) - set(one.effects)
    return len(mine) == len(others) == 1 and mine <= twins_of(library, others.pop())


def _exchanged(
    case: Case, best: FittedHypothesis, found: dict[frozenset[str], FittedHypothesis], worth: Set[str]
) -> FittedHypothesis | None:
    """What is better than the best with one of its effects changed for another, None where nothing is; all that is tried is kept."""
    proposed = thread_map(lambda name: _instead(case, best, name, worth), best.effects)
    proposals = [proposal for own in proposed for proposal in own]
    fitted = [entry for entry in thread_map(lambda one: at_its_place(case, one.begun(case)), proposals) if entry]
    keep_better(found, fitted)
    first = max((entry.evidence for entry in fitted), default=-np.inf)
    near = [entry for entry in fitted if entry.evidence > max(first, best.evidence) - decisions.PLAIN_TO_SEE]
    ends = [entry for entry in thread_map(lambda entry: refined(case, entry), near) if entry]
    keep_better(found, ends)
    end = max(ends, key=lambda entry: entry.evidence, default=best)
    return end if end.evidence > best.evidence + LITTLE_NATS else None


def _instead(case: Case, fitted: FittedHypothesis, name: str, worth: Set[str]) -> list[Proposal]:
    """Effects that promise most in the place of `name`, all else as it was fitted."""
    hypothesis = fitted.fit.hypothesis
    start = fit(case, _without(hypothesis, name), rounds=0) if worth else None
    if start is None:
        return []
    score_tests = score_effects(case, linearised(case, start), sorted(worth - {name}))
    least = max(decisions.TAKEN_IN, decisions.NEGLIGIBLE_SHARE * (fitted.fit.log_likelihood - start.log_likelihood))
    return [Proposal(start, entry) for entry in score_tests if entry.gain > least][: decisions.NEXT]


def _without(hypothesis: Hypothesis, name: str) -> Hypothesis:
    return hypothesis.with_effects({n: values for n, values in hypothesis.effects.items() if n != name})
