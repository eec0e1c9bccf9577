"""A gap that other parameter values explain, beyond their stated spread: then parameters are named, and no effect."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.fit.evidence import FittedHypothesis, evidence
from diagnosis.fit.gauss_newton import Fit, away, fit
from diagnosis.fit.moved import moved_effects, moved_parameters
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis

Array = NDArray[np.float64]
MOST_WIDENINGS = 2  # of a spread beyond the first, each by RETUNE_WIDER: to some 500 of those that are stated


@dataclass(frozen=True, eq=False)
class Retune:
    """The fit where the spreads of what had moved are as wide as it takes, its parameters that left what is stated, the shares of their
    places, by how unlikely each is where it now is, and its evidence."""

    fitted: FittedHypothesis
    parameters: tuple[str, ...]
    places: Mapping[str, float]
    score: float


@dataclass(frozen=True)
class _Wider:
    """How many times as wide the spread of what is set free is taken: a coefficient's by its place in theta, that of all numbers that the
    plant file states of an effect by its name."""

    factors: Mapping[int | str, float]

    def once_more(self, numbers: Iterable[int | str]) -> "_Wider":
        """The same with these RETUNE_WIDER times as wide."""
        return _Wider({**self.factors, **{n: decisions.RETUNE_WIDER * self.factors.get(n, 1.0) for n in numbers}})

    def coefficients(self, count: int) -> Array:
        """Of each coefficient (count,)."""
        return np.array([self.factors.get(place, 1.0) for place in range(count)])


def retune(case: Case, nominal: Fit) -> Retune | None:
    """The likeliest re-tune beyond the stated spread; None where no number leaves it.

    What the fit within the spread had moved is set free, the furthest first, as what a single number did is there shared out among all
    that do nearly the same. Each that is set free costs evidence, the more the wider its spread is taken.
    """
    found: list[Retune] = []
    at, wider = nominal, _Wider({})
    while len(wider.factors) < decisions.RETUNE_MOST:
        left = {number: far for number, far in _moved(case, at).items() if number not in wider.factors}
        if not left:
            break
        wider = wider.once_more([max(left, key=lambda number: left[number])])
        ends = [_held(case, start, wider) for start in _starts(nominal.hypothesis, wider)]
        best = max((end for end in ends if end is not None), key=lambda end: end.score, default=None)
        if best is None:
            break
        found.append(best)
        at = best.fitted.fit
    return max(found, key=lambda entry: entry.score, default=None)


def _moved(case: Case, at: Fit) -> Mapping[int | str, float]:
    """How far each number went that left its spread, and of each effect the furthest."""
    theta = at.hypothesis.theta
    far: dict[int | str, float] = {
        place: abs(float(theta[place])) for place in moved_parameters(case, theta, decisions.BEYOND_CHANCE)
    }
    for entry in moved_effects(at, decisions.BEYOND_CHANCE):
        distance = abs(entry.of(at.hypothesis) - (entry.stated or 0.0)) / entry.scale
        far[entry.effect] = max(distance, far.get(entry.effect, 0.0))
    return far


def _starts(nominal: Hypothesis, wider: _Wider) -> tuple[Hypothesis, Hypothesis]:
    """Where the spread held all, and the same with what is not set free as it is stated."""
    alone = np.where([place in wider.factors for place in range(len(nominal.theta))], nominal.theta, 0.0)
    return nominal, replace(nominal, theta=alone)


def _held(case: Case, start: Hypothesis, wider: _Wider) -> Retune | None:
    """The fit within spreads that are wide enough to hold what is set free; None where there is none, or nothing left what is stated."""
    found = _fitted(case, start, wider)
    for _ in range(MOST_WIDENINGS):
        beyond = [] if found is None else [n for n in _moved(_with_spreads(case, wider), found) if n in wider.factors]
        if found is None or not beyond:
            break
        start, wider = _as_stated(found, wider).hypothesis, wider.once_more(beyond)
        found = _fitted(case, start, wider)
    return (
        None if found is None else _told(case, _as_stated(found, wider), evidence(found, case.library.effects), wider)
    )


def _fitted(case: Case, start: Hypothesis, wider: _Wider) -> Fit | None:
    """The fit within wider spreads, in which it counts, from a start that counts in the stated ones."""
    wide = _with_spreads(case, wider)
    found = fit(wide, replace(start, theta=start.theta / wider.coefficients(len(case.free))), rounds=6)
    return None if found is None else fit(wide, with_process_noise(wide, found.hypothesis), rounds=6)


def _told(case: Case, stated: Fit, explained: float, wider: _Wider) -> Retune | None:
    """What left the stated spreads in a fit that counts in these; None where nothing did."""
    theta = stated.hypothesis.theta
    far = [place for place in moved_parameters(case, theta, decisions.BEYOND_CHANCE) if place in wider.factors]
    numbers = [entry for entry in moved_effects(stated, decisions.BEYOND_CHANCE) if entry.effect in wider.factors]
    if not far and not numbers:
        return None
    names = [str(symbol) for symbol in case.library.bound.model.parameter_symbols]
    parameters = tuple(names[int(case.free[place])] for place in far)
    told = (*parameters, *(f"{entry.effect}.{entry.parameter.symbol}" for entry in numbers))
    where = [*(places_of(case, name) for name in parameters), *([entry.effect.split(".")[0]] for entry in numbers)]
    distances = np.append(theta[far], away(stated.hypothesis, numbers)[len(theta) :])
    score = explained - decisions.RETUNE_NATS * len(told)
    return Retune(FittedHypothesis((), stated, explained), told, _shares(where, distances), float(score))


def _shares(where: Sequence[Sequence[str]], distances: Array) -> dict[str, float]:
    """Of the places of each number, by the nats that its distance in standard deviations costs."""
    costs = distances**2 / np.sum(distances**2)
    found: defaultdict[str, float] = defaultdict(float)
    for places, cost in zip(where, costs.tolist(), strict=True):
        for place in places:
            found[place] += cost / len(places)
    return dict(found)


def _as_stated(found: Fit, wider: _Wider) -> Fit:
    """The fit of a wider case counted in the stated standard deviations."""
    theta = found.hypothesis.theta
    numbers = np.array([wider.factors.get(entry.effect, 1.0) for entry in found.free])
    units = np.append(wider.coefficients(len(theta)), numbers)
    free = [replace(entry, scale=entry.scale / unit) for entry, unit in zip(found.free, numbers, strict=True)]
    return replace(
        found,
        hypothesis=replace(found.hypothesis, theta=wider.coefficients(len(theta)) * theta),
        free=tuple(free),
        information=found.information / np.outer(units, units),
        pull=found.pull / units,
    )


def _with_spreads(case: Case, wider: _Wider) -> Case:
    """The case with wider spreads."""
    sd = case.library.bound.sd.copy()
    sd[case.free] *= wider.coefficients(len(case.free))
    stated_sd = {
        name: {symbol: wider.factors.get(name, 1.0) * value for symbol, value in of.items()}
        for name, of in case.stated_sd.items()
    }
    return replace(case, library=replace(case.library, bound=replace(case.library.bound, sd=sd)), stated_sd=stated_sd)


def places_of(case: Case, coefficient: str) -> list[str]:
    """Places whose equations hold a coefficient, the nearest first."""
    model = case.library.bound.model
    symbol = sympy.Symbol(coefficient, real=True)
    found = [
        name
        for name, rotor in model.places.rotors.items()
        if symbol in model.rates.get(rotor.speed, sympy.Integer(0)).free_symbols
        or any(symbol in torque.free_symbols for torque in rotor.thrusts.values())
    ]
    if not found:
        parts = {axis.name: (axis.torque, axis.inertia, axis.coulomb) for axis in model.axes}
        found = [name for name, terms in parts.items() if any(symbol in sympy.sympify(t).free_symbols for t in terms)]
    return found
