"""A gap that other parameter values explain, beyond their stated spread: then parameters are named, and no effect."""

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.fit.evidence import FittedHypothesis, log_evidence
from diagnosis.fit.free_numbers import Free
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.known_before import away
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.moved import moved_effects, moved_parameters
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from sim.effect import place_and_kind

Array = NDArray[np.float64]
LEAST_TOLD = 1e-9  # share of a variance: what rounding leaves of none


@dataclass(frozen=True, eq=False)
class Retune:
    """The fit where the spreads of what had moved are as wide as it takes, its parameters that left what is stated, the shares of their
    places, by how unlikely each is where it now is, and its evidence."""

    fitted: FittedHypothesis
    parameters: tuple[str, ...]
    places: Mapping[str, float]
    score: float


@dataclass(frozen=True)
class _Stated:
    """A number that the plant file states: a coefficient by its place in theta, or one of an effect; how far it is from what is stated in
    standard deviations, and the share of the variance that the logs take away."""

    number: int | Free
    moved: float
    told: float

    @property
    def of(self) -> int | str:
        """By what it is set free: all that the file states of an effect together."""
        return self.number if isinstance(self.number, int) else self.number.effect

    @property
    def pull(self) -> float:
        """How surely the logs pull at it.

        (1)  z = |moved| / sqrt(told)

        is |N(0, 1)| where all is as stated, and z^2 / 2 the nats that a fit gains to first order that knows nothing of the number
        beforehand: of one that is known well a log takes next to no variance away, and next to nothing moves it.
        """
        return abs(self.moved) / float(np.sqrt(self.told))

    @property
    def alone(self) -> float:
        """Where the logs alone would have it, in the stated standard deviations."""
        return self.moved / self.told


def retune(case: Case, nominal: Fit) -> Retune | None:
    """The likeliest re-tune beyond the stated spread; None where no number leaves it.

    What the logs pull at most is set free, one number after another, as what a single one did is shared out among all that do nearly the
    same. Its spread is taken ANOTHER_PLANT times as wide, or as wide as the logs alone pull it: a wider one costs evidence.
    """
    found: list[Retune] = []
    at, wider = nominal, dict[int | str, float]()
    while len(wider) < decisions.NEXT:
        rest = (entry for entry in _stated_numbers(case, at) if entry.of not in wider)
        furthest = max(rest, key=lambda entry: entry.pull, default=None)
        if furthest is None or furthest.pull <= decisions.BEYOND_CHANCE:
            break
        wider[furthest.of] = max(float(decisions.ANOTHER_PLANT), abs(furthest.alone))
        ends = [_within(case, start, dict(wider)) for start in (at.hypothesis, _alone(at, furthest))]
        best = max((end for end in ends if end is not None), key=lambda end: end.score, default=None)
        if best is None:
            break
        found.append(best)
        at = best.fitted.fit
    return max(found, key=lambda entry: entry.score, default=None)


def _stated_numbers(case: Case, at: Fit) -> Iterator[_Stated]:
    """All that the plant file states to a spread, each where the top of the linear problem has it: a fit ends a little before."""
    count, step = len(case.free), -np.linalg.solve(at.information, at.pull)
    told = np.maximum(1.0 - np.diag(np.linalg.pinv(at.information)), LEAST_TOLD).tolist()
    yield from map(_Stated, range(count), (at.hypothesis.theta + step[:count]).tolist(), told)
    for entry, further, share in zip(at.free, step[count:].tolist(), told[count:], strict=True):
        if entry.stated is not None:
            yield _Stated(entry, (entry.of(at.hypothesis) - entry.stated) / entry.scale + further, share)


def _alone(at: Fit, freed: _Stated) -> Hypothesis:
    """All as it is stated but for the number that is set free, which is where the logs alone would have it."""
    hypothesis, theta = at.hypothesis, np.zeros_like(at.hypothesis.theta)
    for entry in at.free:
        if entry.stated is not None:
            hypothesis = hypothesis.with_value(entry.effect, entry.parameter.symbol, entry.stated, entry.log)
    if isinstance(freed.number, int):
        theta[freed.number] = freed.alone
        return replace(hypothesis, theta=theta)
    number = freed.number
    value = (number.stated or 0.0) + freed.alone * number.scale
    value = float(np.clip(value, number.parameter.lower, number.parameter.upper))
    return replace(hypothesis, theta=theta).with_value(number.effect, number.parameter.symbol, value, number.log)


def _within(case: Case, start: Hypothesis, wider: Mapping[int | str, float]) -> Retune | None:
    """The fit within wider spreads, from a start that counts in the stated ones; None where there is none, or nothing left these."""
    wide = _with_spreads(case, wider)
    found = fit(wide, replace(start, theta=start.theta / _factors(case, wider)), rounds=6)
    found = None if found is None else fit(wide, with_process_noise(wide, found.hypothesis), rounds=6)
    if found is None:
        return None
    return _told(case, _as_stated(case, found, wider), log_evidence(found, case.library.effects), wider)


def _factors(case: Case, wider: Mapping[int | str, float]) -> Array:
    """How many times as wide each coefficient's spread is taken (free,)."""
    return np.array([wider.get(place, 1.0) for place in range(len(case.free))])


def _told(case: Case, stated: Fit, explained: float, wider: Collection[int | str]) -> Retune | None:
    """What left the stated spreads in a fit that counts in these; None where nothing did."""
    theta = stated.hypothesis.theta
    far = [place for place in moved_parameters(theta, decisions.BEYOND_CHANCE) if place in wider]
    numbers = [entry for entry in moved_effects(stated, decisions.BEYOND_CHANCE) if entry.effect in wider]
    if not far and not numbers:
        return None
    names = [str(symbol) for symbol in case.library.bound.model.parameter_symbols]
    parameters = tuple(names[int(case.free[place])] for place in far)
    told = (*parameters, *(f"{entry.effect}.{entry.parameter.symbol}" for entry in numbers))
    where = [*(places_of(case, name) for name in parameters), *([place_and_kind(entry.effect)[0]] for entry in numbers)]
    distances = np.append(theta[far], away(stated.hypothesis, numbers)[len(theta) :])
    score = explained - decisions.chance_nats() * len(told)
    return Retune(FittedHypothesis((), stated, explained), told, _shares(where, distances), float(score))


def _shares(where: Sequence[Sequence[str]], distances: Array) -> dict[str, float]:
    """Of the places of each number, by the nats that its distance in standard deviations costs."""
    costs = distances**2 / np.sum(distances**2)
    found: defaultdict[str, float] = defaultdict(float)
    for places, cost in zip(where, costs.tolist(), strict=True):
        for place in places:
            found[place] += cost / len(places)
    return dict(found)


def _as_stated(case: Case, found: Fit, wider: Mapping[int | str, float]) -> Fit:
    """The fit within wider spreads, counted in the stated ones."""
    factors = _factors(case, wider)
    numbers = np.array([wider.get(entry.effect, 1.0) for entry in found.free])
    units = np.append(factors, numbers)
    free = [replace(entry, scale=entry.scale / unit) for entry, unit in zip(found.free, numbers, strict=True)]
    return replace(
        found,
        hypothesis=replace(found.hypothesis, theta=factors * found.hypothesis.theta),
        free=tuple(free),
        information=found.information / np.outer(units, units),
        pull=found.pull / units,
    )


def _with_spreads(case: Case, wider: Mapping[int | str, float]) -> Case:
    """The case with wider spreads."""
    sd = case.library.bound.sd.copy()
    sd[case.free] *= _factors(case, wider)
    stated_sd = {
        name: {symbol: wider.get(name, 1.0) * value for symbol, value in of.items()}
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
