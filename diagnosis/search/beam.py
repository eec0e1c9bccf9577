"""The search for what is missing: pairs and triples from the best of each size, single effects first, every one fitted with the plant."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from diagnosis import decisions
from diagnosis.detect.instants import happened
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import ScoreTest
from diagnosis.detect.unlike import unlike
from diagnosis.fit.evidence import FittedHypothesis, least_near
from diagnosis.hypothesis.case import Case
from diagnosis.search.exchange import exchange, fit_twins, is_twin, shrink
from diagnosis.search.fitting import Proposal, in_all_logs, keep_better, once_more, refined
from diagnosis.search.noise_beside import with_noise_beside, with_noise_of
from diagnosis.search.own_events import with_own_events
from diagnosis.search.singles import Alone, best_of, first_of_each, fit_to_end, under_noise, worth_testing
from diagnosis.search.sure_sizes import is_certain, kept_by_size
from jobs.thread_map import thread_map
from records.reasons import Decision


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


def search(case: Case, names: Sequence[str], begun: Alone) -> Search:
    """Fit pairs and triples of `names` that grow from the single effects."""
    found, first, worth = dict(begun.found), begun.nominal, begun.worth
    for beam in (decisions.NEXT, decisions.NEXT - 1):  # pairs, then triples
        size = max((len(chosen) for chosen in found), default=0)
        best = beam_of(case, [entry for entry in found.values() if len(entry.effects) == size], first, beam)
        grown, worth = _grown(case, best, names, worth)
        if not best or not fit_to_end(case, first_of_each(case, grown, found), found, best[0]):
            break
        exchange(case, found, worth)
        shrink(case, found)
        fit_twins(case, found, best_of(found))
        if best_of(found).evidence <= best[0].evidence:
            break
    _add_under_noise(case, found, under_noise(case, begun), names, worth)
    _settle(case, found, first)
    told = [entry for entry in found.values() if happened(case, entry.fit.hypothesis)]
    certain = [entry for entry in told if is_certain(entry, found)]
    fitted = sorted([first, *(certain or told)], key=lambda entry: -entry.evidence)
    rules = kept_by_size(found, certain, fitted[0])
    return Search(tuple(fitted), first, bool(certain), begun.linearisation, begun.score_tests, rules)


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


def _add_under_noise(
    case: Case,
    found: dict[frozenset[str], FittedHypothesis],
    singles: Mapping[frozenset[str], FittedHypothesis],
    names: Sequence[str],
    worth: frozenset[str],
) -> None:
    """Add single effects that lead under noise with a memory to what was `found` without, and pairs that grow from the best of them: such
    noise hides what a further effect explains, so that pairs of the others are sought without."""
    if not singles:
        return
    keep_better(found, singles.values())
    leads = best_of(singles)
    grown, _ = _grown(case, [leads], names, worth)
    fit_to_end(case, first_of_each(case, grown, found), found, leads)


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
    worth = worth | worth_testing(score_tests) if single else worth
    others = thread_map(lambda fitted: asked(fitted, worth)[1], best[1:])
    return ([proposal for own in (first, *others) for proposal in own] if first else []), worth
