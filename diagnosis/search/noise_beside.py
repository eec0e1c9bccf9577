"""Noise with a memory beside names: names are compared under the noise that each has then, or none is.

Noise that is white alone prefers names that colour it. So what could yet lead is fitted under the noise of the likeliest, and with its own
where that promises more.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence

from diagnosis import decisions
from diagnosis.fit.evidence import FittedHypothesis, as_fitted, least_near
from diagnosis.fit.foretold import better_noise_of
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import with_memory, with_memory_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import as_noisy, has_memory
from diagnosis.search.exchange import is_twin
from diagnosis.validate.fitted_logs import FittedLogs
from jobs.thread_map import thread_map

NOISY_ROUNDS = 4


def with_noise_beside(
    case: Case, fitted: Sequence[FittedHypothesis], nominal: FittedHypothesis
) -> list[FittedHypothesis]:
    """Hypotheses with the noise with a memory that the logs tell of beside their names, each with its own, where that is likelier; none
    where the best of them, all that come near it, and what predicts as well with fewer effects take none or take what is no noise.

    Noise that is white alone prefers names that colour it: a lag of the sensor smooths what in truth is a smooth torque. But noise may
    also take what a name or a parameter explains: a second of these logs is predicted worse for it then.
    Where it does so beside the best, evidence under it is not to be compared with evidence without. Where the best leave none, it would
    only take what the others lack. Of each number of effects those are asked that it could bring near; then what is hardly told from those
    that lead, and the likeliest without each of its effects and with one more.
    """
    ranked = sorted(fitted, key=lambda entry: -entry.evidence)
    best, first = _first_that_takes_any(case, ranked) if ranked else (None, None)
    if best is None or first is None:
        return []
    sizes = {len(entry.effects) for entry in fitted}
    others = [[entry for entry in ranked if len(entry.effects) == size and entry is not best] for size in sizes]
    asked = [entry for group in others for entry in _in_reach(case, first, group, least_near(first, nominal))]
    found = [first, *_all_noisy(case, asked, first)]
    known = {frozenset(entry.effects) for entry in found}
    likeliest = max(found, key=lambda entry: entry.evidence)
    beside = [*_twins(case, ranked, found), *_fewer(ranked, likeliest), *_more(ranked, likeliest)]
    further = [entry for entry in dict.fromkeys(beside) if frozenset(entry.effects) not in known]
    return [*found, *_all_noisy(case, further, first)]


def _first_that_takes_any(
    case: Case, ranked: Sequence[FittedHypothesis]
) -> tuple[FittedHypothesis, FittedHypothesis] | tuple[None, None]:
    """The first of the best that takes noise with a memory, and it with that; after them the best of each fewer effects that it brings near
    them and that then predicts as well, as an effect that was taken in for want of such noise leaves none, and predicts nothing."""
    least = ranked[0].evidence - decisions.PLAIN_TO_SEE
    near = [entry for entry in ranked if entry.evidence > least]
    sizes = range(len(ranked[0].effects) - 1, 0, -1)
    fewer = (next((entry for entry in ranked if len(entry.effects) == size), None) for size in sizes)
    could = (entry for entry in fewer if entry and entry not in near and _reach(case, entry, 0.0) > least)
    for entry in itertools.chain(near, could):
        noisy = with_own_noise(case, entry)
        if noisy is None or noisy.evidence <= least or not has_memory(case, noisy.fit.hypothesis):
            continue
        if entry in near or _predicts_as_well(case, noisy, ranked[0]):
            return entry, noisy
    return None, None


def _predicts_as_well(case: Case, noisy: FittedHypothesis, other: FittedHypothesis) -> bool:
    return FittedLogs(case).gain(noisy.fit.hypothesis, other.fit.hypothesis) >= -decisions.MATTERS


def _twins(
    case: Case, fitted: Sequence[FittedHypothesis], found: Sequence[FittedHypothesis]
) -> Iterator[FittedHypothesis]:
    """What is hardly told from those that now lead: between twins noise decides, so that those are asked which lacked no more than it
    gained beside the other."""
    before = {frozenset(entry.effects): entry for entry in fitted}
    least = max(entry.evidence for entry in found) - decisions.PLAIN_TO_SEE
    for entry in (entry for entry in found if entry.evidence > least):
        own = before[frozenset(entry.effects)]
        gained = entry.evidence - own.evidence
        yield from (other for other in hardly_told(case, own, fitted) if own.evidence - other.evidence <= gained)


def _fewer(fitted: Sequence[FittedHypothesis], likeliest: FittedHypothesis) -> Iterator[FittedHypothesis]:
    """The likeliest without each of its effects: whether one is needed is asked under one noise."""
    fewer = len(likeliest.effects) - 1
    return (entry for entry in fitted if len(entry.effects) == fewer and set(entry.effects) < set(likeliest.effects))


def _more(fitted: Sequence[FittedHypothesis], likeliest: FittedHypothesis) -> Sequence[FittedHypothesis]:
    """The best of those that have one effect beside the likeliest's: whether one is missing is asked under one noise too."""
    more = len(likeliest.effects) + 1
    return [e for e in fitted if len(e.effects) == more and set(e.effects) > set(likeliest.effects)][: decisions.NEXT]


def _all_noisy(case: Case, asked: Sequence[FittedHypothesis], first: FittedHypothesis) -> list[FittedHypothesis]:
    """Those asked, fitted under the noise of the first; with their own those that it could bring near the likeliest, but for those in which
    it would be more than noise.

    The likeliest of them that takes any goes first: beside what it then has others may be out of reach, and what lacks the same as it
    shows the same in its innovations, so that its noise is tried beside them.
    """
    if not asked:
        return []
    left = _promised(case, first)
    begun = dict(zip(asked, thread_map(lambda entry: _under_noise_of(case, entry, first), asked), strict=True))
    reach = dict(zip(asked, thread_map(lambda entry: _reach(case, begun[entry], left), asked), strict=True))
    least = max(entry.evidence for entry in (first, *begun.values())) - decisions.PLAIN_TO_SEE
    near = [entry for entry in sorted(asked, key=lambda entry: -begun[entry].evidence) if reach[entry] >= least]
    own = _until_noise(case, near, begun, first, left, least)
    known = [first, *(end for end in own.values() if end is not None and has_memory(case, end.fit.hypothesis))]
    least = max(least, *(entry.evidence - decisions.PLAIN_TO_SEE for entry in known))
    rest = [entry for entry in near if entry not in own and reach[entry] >= least]
    found = thread_map(lambda entry: _own_noise(case, entry, begun[entry], known, left, least), rest)
    own |= zip(rest, found, strict=True)
    return [end for entry in asked if (end := own.get(entry, begun[entry])) is not None]


def _until_noise(
    case: Case,
    near: Sequence[FittedHypothesis],
    begun: Mapping[FittedHypothesis, FittedHypothesis],
    first: FittedHypothesis,
    left: float,
    least: float,
) -> dict[FittedHypothesis, FittedHypothesis | None]:
    """What own noise makes of those near, in turn, down to the first that takes some with a memory."""
    own = dict[FittedHypothesis, FittedHypothesis | None]()
    for entry in near:
        own[entry] = found = _own_noise(case, entry, begun[entry], [first], left, least)
        if found is not None and has_memory(case, found.fit.hypothesis):
            break
    return own


def _reach(case: Case, fitted: FittedHypothesis, left: float) -> float:
    """The evidence that noise with a memory could give a hypothesis, by what its innovations foretell beyond `left` nats: more than that,
    as parameters come back which bent for want of it."""
    return fitted.evidence + decisions.PARAMETERS_BACK * max(_promised(case, fitted) - left, 0.0)


def _under_noise_of(case: Case, fitted: FittedHypothesis, known: FittedHypothesis) -> FittedHypothesis:
    """The hypothesis fitted under the noise of another as it is, or itself where that is no likelier."""
    found = _fit_under(case, fitted, known, NOISY_ROUNDS)
    return max((fitted, *([] if found is None else [as_fitted(case, found)])), key=lambda entry: entry.evidence)


def _fit_under(case: Case, fitted: FittedHypothesis, known: FittedHypothesis, rounds: int) -> Fit | None:
    """The fit after so many rounds under the noise of another; None where the filter fails."""
    return fit(case, as_noisy(case, fitted.fit.hypothesis, known.fit.hypothesis), rounds=rounds)


def _own_noise(
    case: Case,
    fitted: FittedHypothesis,
    begun: FittedHypothesis,
    known: Sequence[FittedHypothesis],
    left: float,
    least: float,
) -> FittedHypothesis | None:
    """The hypothesis with the noise of one that is `known`, from where it was `begun` under such; or with what it shows by itself, where
    its innovations promise more than the `left` nats that those of the first foretell, and evidence of as much as `least`, and that is
    likelier."""
    found = list[FittedHypothesis]()
    for other in known:
        shared = _settled_under(case, fitted, begun, other) if has_memory(case, other.fit.hypothesis) else fitted
        if shared is None:
            continue
        found.append(shared)
        promised = _promised(case, shared) - left
        # Under noise with a memory parameters have come back already.
        back = 1.0 if has_memory(case, shared.fit.hypothesis) else decisions.PARAMETERS_BACK
        if promised < decisions.TAKEN_IN or shared.evidence + back * promised < least:
            return max(found, key=lambda entry: entry.evidence)
    own = with_own_noise(case, fitted)
    return max((*found, *([] if own is None else [own])), key=lambda entry: entry.evidence, default=None)


def with_noise_of(case: Case, fitted: Sequence[FittedHypothesis], known: FittedHypothesis) -> list[FittedHypothesis]:
    """Hypotheses with the noise with a memory that one has which they are to be compared with: none where it has none. Those in which it
    would be more than noise are left out."""
    if not has_memory(case, known.fit.hypothesis):
        return list(fitted)
    found = thread_map(lambda entry: _settled_under(case, entry, entry, known), fitted)
    return [entry for entry in found if entry is not None]


def _in_reach(
    case: Case, noisy: FittedHypothesis, others: Sequence[FittedHypothesis], least: float
) -> list[FittedHypothesis]:
    """Those of the others, best first, that noise with a memory could bring to the `least` evidence: under that of the likeliest, `noisy`,
    to first order, or under one of their own, by what their innovations foretell. The best of them, and those that promise most by each."""
    left = _promised(case, noisy)

    def promised(entry: FittedHypothesis) -> tuple[float, float]:
        return entry.evidence + _further(case, entry, noisy), _reach(case, entry, left)

    reach = dict(zip(others, thread_map(promised, others), strict=True))
    near = [entry for entry in others if max(reach[entry]) >= least]
    furthest = [sorted(near, key=lambda entry: -reach[entry][by])[: decisions.NEXT] for by in range(2)]
    return list(dict.fromkeys([*near[:1], *furthest[0], *furthest[1]]))


def _further(case: Case, fitted: FittedHypothesis, known: FittedHypothesis) -> float:
    """What a hypothesis gains under the noise of another, to first order in all numbers, as they come back which bent for want of it."""
    found = _fit_under(case, fitted, known, 0)
    return 0.0 if found is None else found.log_posterior + found.promised - fitted.fit.log_posterior


def hardly_told(case: Case, first: FittedHypothesis, others: Sequence[FittedHypothesis]) -> list[FittedHypothesis]:
    """The twins of the first among the others, theirs, and so on: a lag before the plant is no twin of a delay behind it, but both are of
    a lag there, and noise that is taken beside some of them must be beside all."""
    found = [first]
    for entry in found:  # which grows on the way
        found += [other for other in others if other not in found and is_twin(case.library, other, entry)]
    return found[1:]


def _promised(case: Case, fitted: FittedHypothesis) -> float:
    return better_noise_of(case, fitted.fit.hypothesis)


def with_own_noise(case: Case, fitted: FittedHypothesis) -> FittedHypothesis | None:
    """The hypothesis with its noise with a memory, or itself where that is no likelier; None where it would be more than noise."""
    found = with_memory(case, fitted.fit)
    return fitted if found is fitted.fit else _noise_alone(case, fitted, found)


def _settled_under(
    case: Case, fitted: FittedHypothesis, begun: FittedHypothesis, known: FittedHypothesis
) -> FittedHypothesis | None:
    """The same with noise sought from that of one that is `known`, and all else from where it was `begun`."""
    return _noise_alone(case, fitted, with_memory_of(case, begun.fit, known.fit.hypothesis))


def _noise_alone(case: Case, fitted: FittedHypothesis, found: Fit) -> FittedHypothesis | None:
    """What was found with noise with a memory, or the hypothesis itself where that is likelier; None where it predicts worse by more than
    what matters: then it took what is no noise."""
    told = as_fitted(case, found)
    if told.evidence <= fitted.evidence:
        return fitted
    return told if _predicts_as_well(case, told, fitted) else None
