"""The search for what is missing: single effects, then pairs and triples from the best of each size, every one fitted with the plant."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.detect.instants import happened
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import ScoreTest
from diagnosis.detect.unlike import unlike
from diagnosis.fit.evidence import FittedHypothesis, as_fitted, least_near
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.search.exchange import exchange, fit_twins, is_twin, shrink, twins_of
from diagnosis.search.fitting import Proposal, in_all_logs, is_astray, keep_better, once_more, refined, rough
from diagnosis.search.noise_beside import with_noise_beside, with_noise_of
from diagnosis.search.own_events import with_own_events
from diagnosis.search.sure_sizes import is_certain, kept_by_size
from jobs.thread_map import thread_map
from records.reasons import Decision


@dataclass(frozen=True, eq=False)
class FirstFits:
    """Single effects `begun` from the nominal plant, none fitted to its end, and those that are `found` otherwise; `linearisation` and
    `score_tests` are those of the nominal plant."""

    found: Mapping[frozenset[str], FittedHypothesis]
    begun: tuple[FittedHypothesis, ...]
    nominal: FittedHypothesis
    linearisation: Linearisation
    score_tests: tuple[ScoreTest, ...]

    @property
    def best(self) -> FittedHypothesis:
        """The likeliest of them and the nominal plant."""
        return max((*self.found.values(), *self.begun, self.nominal), key=lambda entry: entry.evidence)


@dataclass(frozen=True, eq=False)
class Alone:
    """Single effects as fitted, the nominal plant, and the effects that are worth a costly score test beside others; `linearisation` and
    `score_tests` are those of the nominal plant."""

    found: Mapping[frozenset[str], FittedHypothesis]
    nominal: FittedHypothesis
    worth: frozenset[str]
    linearisation: Linearisation
    score_tests: tuple[ScoreTest, ...]

    def best(self, count: int) -> list[FittedHypothesis]:
        """So many of them, the nominal plant among them, best evidence first."""
        return sorted((*self.found.values(), self.nominal), key=lambda entry: -entry.evidence)[:count]


@dataclass(frozen=True, eq=False)
class Search:
    """All that was tried, best evidence first, the nominal plant among it; `linearisation` and `score_tests` are those of the nominal
    plant, `sure` says whether the sizes of what was tried are surely not zero: where none is, all is there."""

    fitted: tuple[FittedHypothesis, ...]
    nominal: FittedHypothesis
    sure: bool
    linearisation: Linearisation
    score_tests: tuple[ScoreTest, ...]
    decisions: tuple[Decision, ...] = ()

    def of(self, effects: Iterable[str]) -> FittedHypothesis | None:
        """The hypothesis of exactly these effects."""
        wanted = frozenset(effects)
        return next((entry for entry in self.fitted if frozenset(entry.effects) == wanted), None)


def first_fits(
    case: Case,
    nominal: FittedHypothesis,
    linearisation: Linearisation,
    score_tests: Sequence[ScoreTest],
    lossy: Fit | None = None,
    beside: FittedHypothesis | None = None,
) -> FirstFits:
    """Begin to fit the `nominal` plant with single effects; `score_tests` are those from there, `lossy` its fit with lost frames, `beside`
    what was fitted already: a search begun anew may not lead there."""
    found: dict[frozenset[str], FittedHypothesis] = {}
    if lossy is not None and case.library.losses is not None:
        found[frozenset((case.library.losses.name,))] = as_fitted(case, lossy)
    least = max(decisions.chance_nats(), decisions.NEGLIGIBLE_SHARE * score_tests[0].gain) if score_tests else 0.0
    proposals = [
        proposal
        for tests in (score_tests, scored_as_stated(case, nominal.fit))
        for proposal in _promising(nominal.fit, _of_all_kinds(case.library, tests), least)
    ]
    begun = first_of_each(case, proposals, found)
    if beside is not None and len(beside.effects) == 1:
        keep_better(found, [entry for entry in (beside, refined(case, beside)) if entry is not None])
    return FirstFits(found, tuple(begun), nominal, linearisation, tuple(score_tests))


def alone(case: Case, first: FirstFits) -> Alone:
    """Fit single effects to their end, from where they begin."""
    found: dict[frozenset[str], FittedHypothesis] = {}
    _end(case, first.begun, found, first.nominal)
    keep_better(found, first.found.values())
    if found:
        fit_twins(case, found, _best(found))
    return Alone(found, first.nominal, _worth(first.score_tests), first.linearisation, first.score_tests)


def scored_as_stated(case: Case, nominal: Fit) -> list[ScoreTest]:
    """Score tests from the plant as stated, under the white noise that it then needs, where the nominal plant went astray: its parameters
    took the part of what is missing then, which shows nothing beside them."""
    if not is_astray(nominal.hypothesis, decisions.ASTRAY):
        return []
    start = replace(nominal.hypothesis, theta=np.zeros_like(nominal.hypothesis.theta))
    stated = fit(case, with_process_noise(case, start), rounds=0)
    return [] if stated is None else score_effects(case, linearised(case, stated), case.library.candidates)


def search(case: Case, names: Sequence[str], begun: Alone) -> Search:
    """Fit pairs and triples of `names` that grow from the single effects."""
    found, first, worth = dict(begun.found), begun.nominal, begun.worth
    for beam in (decisions.NEXT, decisions.NEXT - 1):  # pairs, then triples
        size = max((len(chosen) for chosen in found), default=0)
        best = beam_of(case, [entry for entry in found.values() if len(entry.effects) == size], first, beam)
        grown, worth = _grown(case, best, names, worth)
        if not best or not _end(case, first_of_each(case, grown, found), found, best[0]):
            break
        exchange(case, found, worth)
        shrink(case, found)
        fit_twins(case, found, _best(found))
        if _best(found).evidence <= best[0].evidence:
            break
    _settle(case, found, first)
    told = [entry for entry in found.values() if happened(case, entry.fit.hypothesis)]
    certain = [entry for entry in told if is_certain(entry, found)]
    fitted = sorted([first, *(certain or told)], key=lambda entry: -entry.evidence)
    rules = kept_by_size(found, certain, fitted[0])
    return Search(tuple(fitted), first, bool(certain), begun.linearisation, begun.score_tests, rules)


def _best(found: Mapping[frozenset[str], FittedHypothesis]) -> FittedHypothesis:
    return max(found.values(), key=lambda entry: entry.evidence)


def with_twins(case: Case, told: Search, first: FittedHypothesis) -> Search:
    """The search with what is hardly told from `first`, fitted where that was not tried; itself where all was.

    What is told first may be another than what the search found best: the hold-out has a say in that. They get the noise that it has, as
    noise with a memory beside some alone would decide between them.
    """
    found = {frozenset(entry.effects): entry for entry in told.fitted}
    ends = with_noise_of(case, fit_twins(case, found, first), first)
    kept = [entry for entry in ends if is_certain(entry, found) and happened(case, entry.fit.hypothesis)]
    if not kept:
        return told
    better = {frozenset(entry.effects): entry for entry in told.fitted}
    keep_better(better, kept)
    return replace(told, fitted=tuple(sorted(better.values(), key=lambda entry: -entry.evidence)))


def _worth(score_tests: Sequence[ScoreTest]) -> frozenset[str]:
    """Effects that are worth a costly score test beside others."""
    best = score_tests[: decisions.most_asked()]
    return frozenset(entry.effect for entry in best if entry.gain > decisions.chance_nats())


def beam_of(
    case: Case, fitted: Sequence[FittedHypothesis], nominal: FittedHypothesis, count: int
) -> list[FittedHypothesis]:
    """The hypotheses that are worth a further effect, best evidence first; of those that are hardly told apart the best, as the same
    grows beside them; the last place is the likeliest's, whatever its prior chi-squared.

    Where a second effect is missing, parameters bend to take its part: then a right first effect shows in its likelihood alone.
    """
    ranked = sorted(fitted, key=lambda entry: -entry.evidence)
    likeliest = max(ranked, key=lambda entry: entry.fit.log_likelihood, default=None)
    if likeliest is None:
        return []
    near = least_near(ranked[0], nominal)
    kept: list[FittedHypothesis] = []
    for entry in ranked:
        if len(kept) == count or (len(entry.effects) > 1 and entry.evidence <= near):
            break
        kept += [] if any(_same_so_far(case, entry, other) for other in kept) else [entry]
    return kept if count < 3 or likeliest in kept else [*kept[: count - 1], likeliest]


def _same_so_far(case: Case, entry: FittedHypothesis, other: FittedHypothesis) -> bool:
    """Whether the same will grow beside both: they are twins, and these data do not tell them apart."""
    return other.evidence - entry.evidence <= decisions.PLAIN_TO_SEE and is_twin(case.library, entry, other)


def _of_all_kinds(library: EffectLibrary, score_tests: Sequence[ScoreTest]) -> list[ScoreTest]:
    """The first of the score tests, and so many in all of which none is hardly told from one before: one cause that several effects look
    like would else take the place of another, which to first order may promise less."""
    kinds: list[ScoreTest] = []
    for entry in score_tests:
        alike = twins_of(library, entry.effect)
        kinds += [] if any(other.effect in alike for other in kinds) else [entry]
    return list(dict.fromkeys([*score_tests[: decisions.SINGLES], *kinds[: decisions.SINGLES]]))


def _promising(start: Fit, score_tests: Sequence[ScoreTest], least: float) -> list[Proposal]:
    """Effects that gain more than `least` from `start`, best first."""
    return [Proposal(start, entry) for entry in score_tests if entry.gain > least]


def _settle(case: Case, found: dict[frozenset[str], FittedHypothesis], nominal: FittedHypothesis) -> None:
    """Once more the best of all with the twins of the first, until effects and all noise agree: a fit not yet at its end would lose to one
    with an idle effect. What is far from the best is left as it is."""
    best = sorted((entry for entry in found.values() if is_certain(entry, found)), key=lambda entry: -entry.evidence)
    best = [entry for entry in best if entry.evidence > least_near(best[0], nominal)]
    twins = [entry for entry in best if is_twin(case.library, entry, best[0])]
    asked = [frozenset(entry.effects) for entry in dict.fromkeys([*best[: decisions.NEXT], *twins])]
    for step in (refined, in_all_logs, once_more, with_own_events):
        ends = thread_map(lambda names, step=step: step(case, found[names]), asked)
        keep_better(found, [end for end in ends if end is not None])
    keep_better(
        found, with_noise_beside(case, [entry for entry in found.values() if is_certain(entry, found)], nominal)
    )


def _grown(
    case: Case, best: Sequence[FittedHypothesis], names: Sequence[str], worth: frozenset[str]
) -> tuple[list[Proposal], frozenset[str]]:
    """The best hypotheses, each with the further effects that promise most beside it and beside one another, none where the first has none;
    and the effects that are `worth` a costly score test beside others.

    Beside the best single effect all are asked: under a plant that lacks it others may show nothing.
    """

    def asked(fitted: FittedHypothesis, worth: frozenset[str] | None) -> tuple[list[ScoreTest], list[Proposal]]:
        linearisation = linearised(case, fitted.fit)
        score_tests = score_effects(case, linearisation, names, worth)
        promising = [entry for entry in score_tests if entry.gain > decisions.TAKEN_IN][: decisions.most_asked()]
        return score_tests, [Proposal(fitted.fit, entry) for entry in unlike(linearisation, promising, decisions.NEXT)]

    if not best:
        return [], worth
    single = len(best[0].effects) == 1
    score_tests, first = asked(best[0], None if single else worth)
    worth = worth | _worth(score_tests) if single else worth
    others = thread_map(lambda fitted: asked(fitted, worth)[1], best[1:])
    return ([proposal for own in (first, *others) for proposal in own] if first else []), worth


def _names_of(case: Case, proposal: Proposal) -> frozenset[str]:
    return frozenset((*case.added(proposal.start.hypothesis.effects), proposal.score_test.effect))


def first_of_each(
    case: Case, proposals: Sequence[Proposal], known: Mapping[frozenset[str], FittedHypothesis]
) -> list[FittedHypothesis]:
    """The first fit of each proposal that is new, the better one where two lead to the same effects: they may end on other hills."""
    wanted = [proposal for proposal in proposals if _names_of(case, proposal) not in known]
    firsts: dict[frozenset[str], FittedHypothesis] = {}
    keep_better(firsts, (entry for entry in thread_map(lambda proposal: rough(case, proposal), wanted) if entry))
    return list(firsts.values())


def worth_ending(begun: Sequence[FittedHypothesis], known: FittedHypothesis) -> list[FittedHypothesis]:
    """What gains a fair share of the most that any gains over what is `known`. Where none gains, the best and what is near it: they have
    the noise of what they grew from, as that still lacked what they brought, and what is known has its own."""
    best, first = max(entry.evidence for entry in begun), known.evidence
    if best > first:
        return [entry for entry in begun if entry.evidence - first >= decisions.PROMISED_SHARE * (best - first)]
    near = [entry for entry in begun if entry.evidence > best - decisions.PLAIN_TO_SEE]
    return sorted(near, key=lambda entry: -entry.evidence)[: decisions.NEXT]


def _end(
    case: Case,
    begun: Sequence[FittedHypothesis],
    found: dict[frozenset[str], FittedHypothesis],
    known: FittedHypothesis,
) -> bool:
    """Fit those to the end that gain most over what is `known`; whether anything was added to what is `found`."""
    if not begun:
        return False
    good = worth_ending(begun, known)
    ends = [entry for entry in thread_map(lambda fitted: refined(case, fitted), good) if entry]
    ends = thread_map(lambda fitted: in_all_logs(case, fitted), ends)
    done = sorted(ends, key=lambda entry: -entry.evidence)
    # Ends take the place of what was begun, also where they are less likely: a first fit may hold a scatter that readings do not show.
    found.update({frozenset(entry.effects): entry for entry in (*begun, *done)})
    strayed = [e for e in done[: decisions.NEXT] if is_astray(e.fit.hypothesis, decisions.ASTRAY)]
    keep_better(found, thread_map(lambda entry: once_more(case, entry), strayed))
    return True
