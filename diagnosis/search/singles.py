"""Single effects: as they begin, as they end, and under the noise with a memory that the likeliest of them leaves."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import ScoreTest
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import as_noisy
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.search.exchange import fit_twins, is_twin, twins_of
from diagnosis.search.fitting import Proposal, in_all_logs, is_astray, keep_better, once_more, refined, rough
from diagnosis.search.noise_beside import with_own_noise
from jobs.thread_map import thread_map

PLAIN_ROUNDS = 8  # of the plant alone under a name's noise: score tests count from its end


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
        for proposal in promising(nominal.fit, _of_all_kinds(case.library, tests), least)
    ]
    begun = first_of_each(case, proposals, found)
    if beside is not None and len(beside.effects) == 1:
        keep_better(found, [entry for entry in (beside, refined(case, beside)) if entry is not None])
    return FirstFits(found, tuple(begun), nominal, linearisation, tuple(score_tests))


def alone(case: Case, first: FirstFits) -> Alone:
    """Fit single effects to their end, from where they begin."""
    found: dict[frozenset[str], FittedHypothesis] = {}
    fit_to_end(case, first.begun, found, first.nominal)
    keep_better(found, first.found.values())
    if found:
        fit_twins(case, found, best_of(found))
    return Alone(found, first.nominal, worth_testing(first.score_tests), first.linearisation, first.score_tests)


def under_noise(case: Case, usual: Alone) -> dict[frozenset[str], FittedHypothesis]:
    """Single effects begun anew under the noise with a memory that the likeliest of them leaves, where then another one leads; else none.

    White noise alone says that the plant told all that is smooth: it bends parameters, and prefers names that smooth. Those are asked that
    promise a fair share of the most there. Noise worth a negligible share of what the likeliest explains bends nothing.
    """
    if not usual.found:
        return {}
    best = best_of(usual.found)
    noisy = with_own_noise(case, best)
    told = max(decisions.PLAIN_TO_SEE, decisions.NEGLIGIBLE_SHARE * (best.evidence - usual.nominal.evidence))
    if noisy is None or noisy.evidence < best.evidence + told:
        return {}
    plain = _plain_under(case, usual, noisy)
    begun = [] if plain is None else _begun_under(case, plain, [noisy], usual.worth)
    if not begun or plain is None:
        return {}
    found = {frozenset(entry.effects): entry for entry in (noisy, *begun)}
    near = sorted(worth_ending(begun, plain), key=lambda entry: -entry.evidence)[: decisions.NEXT]
    keep_better(found, [end for end in thread_map(lambda entry: with_own_noise(case, entry), near) if end is not None])
    leads = best_of(found)
    if leads.evidence < noisy.evidence + decisions.PLAIN_TO_SEE or is_twin(case.library, leads, best):
        return {}
    fit_twins(case, found, leads)
    return found


def _begun_under(
    case: Case, plain: FittedHypothesis, known: Sequence[FittedHypothesis], worth: Set[str]
) -> list[FittedHypothesis]:
    """First fits beside the plant under its noise, but of those that are `known`."""
    score_tests = score_effects(case, linearised(case, plain.fit), case.library.candidates, worth)
    least = decisions.PROMISED_SHARE * score_tests[0].gain if score_tests else 0.0
    proposals = promising(plain.fit, _of_all_kinds(case.library, score_tests), least)
    return first_of_each(case, proposals, {frozenset(entry.effects): entry for entry in known})


def _plain_under(case: Case, usual: Alone, noisy: FittedHypothesis) -> FittedHypothesis | None:
    """The plant alone under the noise of a name, fitted from where it was and from as stated; None where it cannot run along its logs."""
    hypothesis = usual.nominal.fit.hypothesis
    starts = [hypothesis, replace(hypothesis, theta=np.zeros_like(hypothesis.theta))]
    fits = thread_map(lambda one: fit(case, as_noisy(case, one, noisy.fit.hypothesis), rounds=PLAIN_ROUNDS), starts)
    found = [as_fitted(case, one) for one in fits if one is not None]
    return max(found, key=lambda entry: entry.evidence, default=None)


def scored_as_stated(case: Case, nominal: Fit) -> list[ScoreTest]:
    """Score tests from the plant as stated, under the white noise that it then needs, where the nominal plant went astray: its parameters
    took the part of what is missing then, which shows nothing beside them."""
    if not is_astray(nominal.hypothesis, decisions.ASTRAY):
        return []
    start = replace(nominal.hypothesis, theta=np.zeros_like(nominal.hypothesis.theta))
    stated = fit(case, with_process_noise(case, start), rounds=0)
    return [] if stated is None else score_effects(case, linearised(case, stated), case.library.candidates)


def best_of(found: Mapping[frozenset[str], FittedHypothesis]) -> FittedHypothesis:
    """The likeliest of what was found, beside its prior."""
    return max(found.values(), key=lambda entry: entry.evidence)


def worth_testing(score_tests: Sequence[ScoreTest]) -> frozenset[str]:
    """Effects that are worth a costly score test beside others."""
    best = score_tests[: decisions.most_asked()]
    return frozenset(entry.effect for entry in best if entry.gain > decisions.chance_nats())


def _of_all_kinds(library: EffectLibrary, score_tests: Sequence[ScoreTest]) -> list[ScoreTest]:
    """The first of the score tests, and so many in all of which none is hardly told from one before: one cause that several effects look
    like would else take the place of another, which to first order may promise less."""
    kinds: list[ScoreTest] = []
    for entry in score_tests:
        alike = twins_of(library, entry.effect)
        kinds += [] if any(other.effect in alike for other in kinds) else [entry]
    return list(dict.fromkeys([*score_tests[: decisions.SINGLES], *kinds[: decisions.SINGLES]]))


def promising(start: Fit, score_tests: Sequence[ScoreTest], least: float) -> list[Proposal]:
    """Effects that gain more than `least` from `start`, best first."""
    return [Proposal(start, entry) for entry in score_tests if entry.gain > least]


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


def fit_to_end(
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
