"""The search for what is missing: single effects, then pairs and triples from the best of each size, every one fitted with the plant."""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from diagnosis.abreast import each
from diagnosis.calm import awake, calmed
from diagnosis.case import Case
from diagnosis.fit import WIDE, Fit, fit, from_zero, likelihood
from diagnosis.ground import Ground, ground_of
from diagnosis.hypothesis import Supposed, passes
from diagnosis.inputs import LOST_FRAMES
from diagnosis.screen import Look, look
from diagnosis.unrest import FIRST_UNREST, with_unrest

SINGLES, PARTNERS, BEAM = 7, 3, (3, 2)
CALM_SINGLES = 4  # from looks under calm air, and as many from those under the air as it seems
CLOSE, CLOSE_SHARE = 60.0, 0.05  # nats, and share of the gap, within which another pair is worth a third effect
LEAST_GAIN = 4.0  # of the log likelihood at a first look
FURTHER_GAIN = 10.0  # that a further effect must promise
STEPS_COST = 8.0  # nats for the choice of an input's step among some thousand
SHAPE_COST = 2.0  # nats for a free shape, as if it were known to a seventh of its range
LEAST_SHARE = 0.01  # of the best first look
WORTH = 14
SETTLED = 5
ASTRAY = 2.0  # mean square of the parameters' steps, in standard deviations, beyond which a fit also starts from none
FAR, ONCE_MORE = 1.0, 3  # the same for the best of the fits that were refined
CERTAIN, LIKELY = 3.5, 1.5  # standard deviations
MISSED = 15.0  # nats
LESS = 0.2  # of an effect's size, from which it is fitted once more where more made all worse
LEAST_SLIP = 1.5  # counts
WORTH_REFINING = 0.2  # of the best first fit's gain
POLISHING = (0.2, 0.03, 0.005)  # of a step, as shares, in which a likelier one is looked for,
FINELY = (
    1e-3,
    2e-4,
    4e-5,
)  # and once the rest fits: a range of some hundred steps tells one to a hundredth of a thousandth
NEAR_BEST = 30.0  # nats that a first fit may be short of the best to be fitted to its end
INSTEAD, NEARLY = 3, 0.03  # effects tried in the place of another, and the share of its gain that they must promise


@dataclass(frozen=True, eq=False)
class Tried:
    """A hypothesis with its fit: `effects` its names in order, `evidence` the log evidence by Laplace, unscaled."""

    effects: tuple[str, ...]
    fit: Fit
    evidence: float


@dataclass(frozen=True, eq=False)
class Job:
    """A further effect to fit from a start, whose air may have been `calm`ed."""

    start: Fit
    look: Look
    calm: bool


@dataclass(frozen=True, eq=False)
class Search:
    """All that was tried, best evidence first, the nominal plant among it; `ground` and `looks` are those of the nominal plant."""

    tried: tuple[Tried, ...]
    nominal: Tried
    ground: Ground
    looks: tuple[Look, ...]

    def of(self, effects: Iterable[str]) -> Tried | None:
        """The hypothesis of exactly these effects."""
        wanted = frozenset(effects)
        return next((entry for entry in self.tried if frozenset(entry.effects) == wanted), None)


def evidence(found: Fit) -> float:
    """Log evidence by Laplace's method, with theta normal, sizes WIDE times their reference, shapes known to a factor."""
    size = len(found.supposed.theta)
    sign, volume = np.linalg.slogdet(found.information)
    new = [(row, from_zero(entry.parameter)) for row, entry in enumerate(found.free, size) if entry.stated is None]
    prior = sum(-np.log(WIDE) if is_size else -SHAPE_COST for _, is_size in new)
    shapes = [row for row, is_size in new if not is_size]
    prior -= STEPS_COST * sum(name.endswith("_input.quantization") for name in found.supposed.effects)
    own = 0.5 * sum(float(np.log(max(found.information[row, row], 1.0))) for row in shapes)
    return found.log_posterior - 0.5 * float(volume if sign > 0 else 0.0) + prior + own


def search(
    case: Case, nominal: Fit, names: Sequence[str], ground: Ground, looks: Sequence[Look], lossy: Fit | None = None
) -> Search:
    """Fit the nominal plant with single effects, pairs and triples of `names`; `nominal` is its fit without any, `looks` those from it,
    `lossy` its fit with lost frames."""
    worth = _worth(looks)
    found = {} if lossy is None else {frozenset((LOST_FRAMES,)): _tried(case, lossy)}
    first = Tried((), nominal, evidence(nominal))
    calm = calmed(case, nominal)
    jobs = _promising(nominal, looks, False)[:SINGLES]
    if calm is not None:
        calm_looks = look(case, ground_of(case, calm), names)
        worth |= _worth(calm_looks)
        jobs = [*_promising(calm, calm_looks, True)[:CALM_SINGLES], *jobs[:CALM_SINGLES]]
    _fit_all(case, jobs, found, first)
    for beam in BEAM:
        size = max((len(chosen) for chosen in found), default=0)
        best = beam_of([entry for entry in found.values() if len(entry.effects) == size], first, beam)
        grown = _grown(case, best, names, worth)
        if not grown or not _fit_all(case, grown, found, best[0]):
            break
        exchange(case, found, worth)
    _settle(case, found)
    certain = [entry for entry in found.values() if _certain(entry, found)]
    tried = sorted([first, *(certain or found.values())], key=lambda entry: -entry.evidence)
    return Search(tuple(tried), first, ground, tuple(looks))


def _worth(looks: Sequence[Look]) -> set[str]:
    """Effects that are worth a costly look beside others."""
    return {entry.effect for entry in looks[:WORTH] if entry.gain > LEAST_GAIN}


def beam_of(tried: Sequence[Tried], nominal: Tried, count: int) -> list[Tried]:
    """The hypotheses that are worth a further effect, best evidence first; the last place is the likeliest's, whatever its strain.

    Where a second effect is missing, parameters bend to take its part: then a right first effect shows in its likelihood alone.
    """
    ranked = sorted(tried, key=lambda entry: -entry.evidence)
    likeliest = max(ranked, key=lambda entry: entry.fit.log_likelihood, default=None)
    if likeliest is None:
        return []
    near = ranked[0].evidence - max(CLOSE, CLOSE_SHARE * (ranked[0].evidence - nominal.evidence))
    kept = [entry for entry in ranked[:count] if len(entry.effects) == 1 or entry.evidence > near]
    return kept if count < 3 or likeliest in kept else [*kept[: count - 1], likeliest]


def _promising(start: Fit, looks: Sequence[Look], calm: bool) -> list[Job]:
    """Effects worth a fit from `start`, best first."""
    least = max(LEAST_GAIN, LEAST_SHARE * looks[0].gain) if looks else 0.0
    return [Job(start, entry, calm) for entry in looks if entry.gain > least]


def _settle(case: Case, found: dict[frozenset[str], Tried]) -> None:
    """Once more the best of all, until effect and unrest agree: a fit not yet at its end would lose to one with an idle effect."""
    best = sorted((entry for entry in found.values() if _certain(entry, found)), key=lambda entry: -entry.evidence)
    for entry in each(lambda tried: refined(case, tried), best[:SETTLED]):
        if entry is not None and entry.evidence > found[frozenset(entry.effects)].evidence:
            found[frozenset(entry.effects)] = entry


def _certain(tried: Tried, found: Mapping[frozenset[str], Tried]) -> bool:
    """Whether every effect has a size that is not zero within its spread, or one that may hardly be zero and without which all is far
    less likely: where an axis sticks, the readings beside it alone make that spread."""
    for name, certainty in certainties(tried.fit).items():
        without = found.get(frozenset(tried.effects) - {name})
        missed = 0.0 if without is None else tried.evidence - without.evidence
        if certainty < CERTAIN and (certainty < LIKELY or missed < MISSED):
            return False
    return True


def certainties(fit: Fit) -> dict[str, float]:
    """How far each effect's size is from zero, in standard deviations."""
    count = len(fit.supposed.theta)
    spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(fit.information)), 0.0))[count:]
    sizes: dict[str, float] = {}
    for entry, sd in zip(fit.free, spread, strict=True):
        if entry.parameter.is_size and entry.stated is None:
            away = fit.supposed.effects[entry.effect][entry.parameter.symbol] - (entry.parameter.zero or 0.0)
            certainty = abs(away) / max(float(sd) * entry.scale, 1e-300)
            sizes[entry.effect] = max(sizes.get(entry.effect, 0.0), certainty)
    return sizes


def _grown(case: Case, best: Sequence[Tried], names: Sequence[str], worth: Set[str]) -> list[Job]:
    """The best hypotheses, each with the further effects that promise most beside it; none where the first has none.

    The first also with the one that promises most under the air as it seems: under calm air what is left of a rough rig hides a
    lesser effect.
    """
    if not best:
        return []
    calm = each(lambda tried: calmed(case, tried.fit), best)
    starts = [air or tried.fit for air, tried in zip(calm, best, strict=True)]
    counts = [PARTNERS] * len(best)
    if calm[0] is not None:
        calm, starts, counts = [*calm, None], [*starts, best[0].fit], [*counts, 1]

    def partners(start: Fit, air: Fit | None, count: int) -> list[Job]:
        looks = look(case, ground_of(case, start), names, worth)
        return [Job(start, entry, air is not None) for entry in looks if entry.gain > FURTHER_GAIN][:count]

    jobs = each(partners, starts, calm, counts)
    of_the_first = [*jobs[0], *chain.from_iterable(jobs[len(best) :])]
    return [*of_the_first, *chain.from_iterable(jobs[1 : len(best)])] if of_the_first else []


def _fit_all(
    case: Case,
    jobs: Sequence[Job],
    found: dict[frozenset[str], Tried],
    known: Tried,
) -> bool:
    """Fit each job that is new, those to the end whose first fit gains most over what is `known`; whether anything was added."""
    fresh: dict[tuple[frozenset[str], bool], Job] = {}
    for job in jobs:
        fresh.setdefault((frozenset((*case.added(job.start.supposed.effects), job.look.effect)), job.calm), job)
    wanted = [job for (names, _), job in fresh.items() if names not in found]
    firsts: dict[frozenset[str], Tried] = {}
    _keep_better(firsts, (entry for entry in each(lambda job: _rough(case, job), wanted) if entry))
    rough = list(firsts.values())
    if not rough:
        return False
    best, first = max(entry.evidence for entry in rough), known.evidence
    good = [entry for entry in rough if entry.evidence - first >= WORTH_REFINING * (best - first)]
    ends = [entry for entry in each(lambda tried: refined(case, tried), good) if entry]
    done = sorted(ends, key=lambda entry: -entry.evidence)
    done[:ONCE_MORE] = each(lambda entry: _once_more(case, entry), done[:ONCE_MORE])
    found.update({frozenset(entry.effects): entry for entry in (*rough, *done)})
    return True


def exchange(case: Case, found: dict[frozenset[str], Tried], worth: Set[str]) -> None:
    """Each effect of the best hypothesis in turn changed for others, while that makes it better.

    A right effect that was fitted beside a wrong one, or beside none, may have ended with its numbers and the plant's bent; from where
    the best hypothesis has them it ends well.
    """
    best = max(found.values(), key=lambda entry: entry.evidence)
    fewer = max((entry.evidence for entry in found.values() if len(entry.effects) < len(best.effects)), default=-np.inf)
    while len(best.effects) > 1 and best.evidence > fewer + FURTHER_GAIN:
        better = _exchanged(case, best, found, worth)
        if better is None:
            return
        best = found[frozenset(better.effects)] = better


def _exchanged(case: Case, best: Tried, found: dict[frozenset[str], Tried], worth: Set[str]) -> Tried | None:
    """What is better than the best with one of its effects changed for another, None where nothing is; all that is tried is kept."""
    jobs = [job for jobs in each(lambda name: _instead(case, best, name, worth), best.effects) for job in jobs]
    tried = [entry for entry in each(lambda job: _at_its_place(case, job), jobs) if entry]
    _keep_better(found, tried)
    first = max(tried, key=lambda entry: entry.evidence, default=None)
    if first is None or first.evidence < best.evidence - NEAR_BEST:
        return None
    end = refined(case, first)
    return end if end is not None and end.evidence > best.evidence else None


def _at_its_place(case: Case, job: Job) -> Tried | None:
    """A first fit from where the rest fits already."""
    supposed, entry = job.start.supposed, job.look
    found = fit(case, supposed.with_effects({**supposed.effects, entry.effect: entry.values}), rounds=4)
    found = None if found is None else awake(case, found)
    return None if found is None else _tried(case, found)


def _instead(case: Case, tried: Tried, name: str, worth: Set[str]) -> list[Job]:
    """Effects that promise most in the place of `name`, all else as it was fitted."""
    supposed = tried.fit.supposed
    start = fit(case, supposed.with_effects({n: v for n, v in supposed.effects.items() if n != name}), rounds=0)
    if start is None:
        return []
    looks = look(case, ground_of(case, start), sorted(worth - {name}))
    least = max(FURTHER_GAIN, NEARLY * (tried.fit.log_likelihood - start.log_likelihood))
    return [Job(start, entry, True) for entry in looks if entry.gain > least][:INSTEAD]


def _keep_better(found: dict[frozenset[str], Tried], tried: Iterable[Tried]) -> None:
    """Of each set of effects the better of what was found and what was tried."""
    for entry in tried:
        known = found.setdefault(frozenset(entry.effects), entry)
        if entry.evidence > known.evidence:
            found[frozenset(entry.effects)] = entry


def _once_more(case: Case, tried: Tried) -> Tried:
    """The same begun once more from the parameters as stated, where they have gone far and that ends better."""
    theta = tried.fit.supposed.theta
    if theta @ theta < FAR * len(theta):
        return tried
    start = _from_stated(case, tried.fit.supposed)
    other = None if start is None else refined(case, _tried(case, start))
    return tried if other is None or other.evidence < tried.evidence else other


def _rough(case: Case, job: Job) -> Tried | None:
    """A first joint fit, under the unrest that was there before, or what then shows where that had been lowered."""
    supposed, entry = job.start.supposed, job.look
    start = supposed.with_effects({**supposed.effects, entry.effect: entry.values})
    if entry.effect.endswith("_input.quantization"):
        start = _polished(case, start, entry.effect, POLISHING)
    found = fit(case, start, rounds=4)
    if found is not None and job.calm:
        found = awake(case, found)
    elif found is not None and found.log_posterior < job.start.log_posterior:
        found = _likelier(found, fit(case, _lessened(case, start, entry.effect), rounds=4))
    astray = start if found is None else found.supposed
    if astray.theta @ astray.theta > ASTRAY * len(astray.theta):
        found = _likelier(found, _from_stated(case, start))
    return None if found is None or not _whole_counts(case, found) else _tried(case, found)


def _lessened(case: Case, start: Supposed, effect: str) -> Supposed:
    """The start with an effect of a fifth of its size: what it is added to must not fit worse for it."""
    values = dict(start.effects[effect])
    for parameter in case.kit.effects[effect].parameters:
        if from_zero(parameter):
            zero = parameter.zero or 0.0
            values[parameter.symbol] = zero + LESS * (values[parameter.symbol] - zero)
    return start.with_effects({**start.effects, effect: values})


def _from_stated(case: Case, start: Supposed) -> Fit | None:
    """The fit from the parameters as stated: where the nominal plant had gone far astray, nothing is found from there."""
    calm = np.minimum(start.unrest, FIRST_UNREST)
    found = fit(case, replace(start, theta=np.zeros_like(start.theta), unrest=calm), rounds=4)
    return None if found is None else awake(case, found)


def _likelier(one: Fit | None, other: Fit | None) -> Fit | None:
    if one is None or other is None:
        return one or other
    return one if one.log_posterior >= other.log_posterior else other


def _tried(case: Case, found: Fit) -> Tried:
    return Tried(case.added(found.supposed.effects), found, evidence(found))


def _whole_counts(case: Case, found: Fit) -> bool:
    """Whether every slip of a sensor is at least a count: what is smaller is rounding."""
    kit = case.kit
    for name, values in found.supposed.effects.items():
        if name.endswith(".count_slip"):
            sensor = kit.bound.model.places.sensors[name.split(".")[0]].output
            if abs(values["jump"]) < LEAST_SLIP * kit.bound.plant.sensors[sensor]:
                return False
    return True


def refined(case: Case, tried: Tried) -> Tried | None:
    """The fit with the unrest that then remains."""
    start = with_unrest(case, tried.fit.supposed)
    for name in tried.effects:
        start = _polished(case, start, name, FINELY) if name.endswith("_input.quantization") else start
    found = fit(case, start, rounds=5)
    return None if found is None else _tried(case, found)


def _polished(case: Case, start: Supposed, effect: str, reaches: Sequence[float]) -> Supposed:
    """The start with the likeliest step near it: the likelihood of steps is too rough for slopes."""
    best, value = start, -np.inf
    for reach in reaches:
        middle = best.effects[effect]["q"]
        for q in np.linspace(1.0 - reach, 1.0 + reach, 13) * middle:
            tried = start.with_effects({**start.effects, effect: {"q": float(q)}})
            runs = passes(case, tried)
            if runs is not None and likelihood(runs) > value:
                best, value = tried, likelihood(runs)
    return best
