"""One hypothesis fitted: a first joint fit of an effect with the plant and what was found before, then to its end."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.score_tests import Look, holding
from diagnosis.fit.evidence import Tried, tried_as
from diagnosis.fit.gauss_newton import Fit, fit, from_zero, likelihood
from diagnosis.fit.jitter import scatters, with_jitter
from diagnosis.fit.low_process_noise import awake
from diagnosis.fit.process_noise import unrest_of, with_unrest
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Supposed, passes
from diagnosis.hypothesis.initial_state import FIRST_UNREST

Array = NDArray[np.float64]
ASTRAY = 2.0  # mean square of the parameters' steps, in standard deviations, beyond which a fit also starts from none
FAR = 1.0  # the same for a fit that was refined
LESS = 0.2  # of an effect's size, from which it is fitted once more where more made all worse
LEAST_SLIP = 1.5  # counts
POLISHING = (0.2, 0.03, 0.005)  # of a step, as shares, in which a likelier one is looked for,
FINELY = (1e-3, 2e-4, 4e-5)  # and once the rest fits: some hundred steps of a range tell one to a hundred-thousandth
LEVELS = np.geomspace(
    0.5, 2.0, 7
)  # of a friction that holds an axis: where it holds, slopes do not tell what more of it would do


@dataclass(frozen=True, eq=False)
class Job:
    """A further effect to fit from a start, whose air may have been `calm`ed."""

    start: Fit
    look: Look
    calm: bool


def rough(case: Case, job: Job) -> Tried | None:
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
    found = _scattered(case, found, [entry.effect])
    astray = start if found is None else found.supposed
    if astray.theta @ astray.theta > ASTRAY * len(astray.theta):
        found = _likelier(found, _from_stated(case, start))
    if found is not None and holding(case.kit, [entry.effect]):
        found = _at_its_level(case, found, entry.effect)
    return None if found is None or not _whole_counts(case, found) else tried_as(case, found)


def at_its_place(case: Case, job: Job) -> Tried | None:
    """A first fit from where the rest fits already, under calm air."""
    supposed, entry = job.start.supposed, job.look
    found = fit(case, supposed.with_effects({**supposed.effects, entry.effect: entry.values}), rounds=4)
    found = None if found is None else awake(case, found)
    return None if found is None or not _whole_counts(case, found) else tried_as(case, found)


def refined(case: Case, tried: Tried) -> Tried | None:
    """The fit with the unrest that then remains."""
    start = with_jitter(case, unrest_of(case, tried.fit), tried.effects)
    for name in tried.effects:
        start = _polished(case, start, name, FINELY) if name.endswith("_input.quantization") else start
    for name in holding(case.kit, tried.effects):
        start = _likeliest(case, start, name, LEVELS)
    found = fit(case, start, rounds=5)
    return None if found is None else tried_as(case, found)


def once_more(case: Case, tried: Tried) -> Tried:
    """The same begun once more from the parameters as stated, where they have gone far and that ends better.

    Once under calm air, and once under that of before any log was seen: a filter that expects any motion leads back from further off.
    """
    supposed = tried.fit.supposed
    if supposed.theta @ supposed.theta < FAR * len(supposed.theta):
        return tried
    restless = replace(supposed, unrest=np.full_like(supposed.unrest, FIRST_UNREST))
    starts = [_from_stated(case, begun) for begun in (supposed, restless)]
    ends = [refined(case, tried_as(case, start)) for start in starts if start is not None]
    return max((tried, *(end for end in ends if end is not None)), key=lambda entry: entry.evidence)


def _polished(case: Case, start: Supposed, effect: str, reaches: Sequence[float]) -> Supposed:
    """The start with the likeliest step near it: the likelihood of steps is too rough for slopes."""
    for reach in reaches:
        start = _likeliest(case, start, effect, np.linspace(1.0 - reach, 1.0 + reach, 13))
    return start


def _scattered(case: Case, found: Fit | None, effects: Sequence[str]) -> Fit | None:
    """The fit, or a likelier one where readings come after a delay that scatters: in calmer air then."""
    if found is None or not any(scatters(case, name) for name in effects):
        return found
    start = with_jitter(case, found.supposed, effects)
    if start.effects == found.supposed.effects:
        return found
    return _likelier(found, fit(case, with_unrest(case, start), rounds=4))


def _at_its_level(case: Case, found: Fit, effect: str) -> Fit:
    """The fit, or a likelier one from another level of a friction that holds its axis."""
    start = _likeliest(case, found.supposed, effect, LEVELS)
    if start.effects[effect] == found.supposed.effects[effect]:
        return found
    return _likelier(found, fit(case, start, rounds=4)) or found


def _likeliest(case: Case, start: Supposed, effect: str, factors: Array) -> Supposed:
    """The start with that of the factors on an effect's size that the logs find likeliest."""
    symbol = case.kit.effects[effect].size.symbol
    tried = [
        start.with_effects({**start.effects, effect: {**start.effects[effect], symbol: float(value)}})
        for value in start.effects[effect][symbol] * factors
    ]
    values = [-np.inf if runs is None else likelihood(runs) for runs in (passes(case, entry) for entry in tried)]
    return tried[int(np.argmax(values))] if np.max(values) > -np.inf else start


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


def _whole_counts(case: Case, found: Fit) -> bool:
    """Whether every slip of a sensor is at least a count: what is smaller is rounding."""
    kit = case.kit
    for name, values in found.supposed.effects.items():
        if name.endswith(".count_slip"):
            sensor = kit.bound.model.places.sensors[name.split(".")[0]].output
            if abs(values["jump"]) < LEAST_SLIP * kit.bound.plant.sensors[sensor]:
                return False
    return True


def keep_better(found: dict[frozenset[str], Tried], tried: Iterable[Tried]) -> None:
    """Of each set of effects the better of what was found and what was tried."""
    for entry in tried:
        known = found.setdefault(frozenset(entry.effects), entry)
        if entry.evidence > known.evidence:
            found[frozenset(entry.effects)] = entry
