"""A gap that other parameter values explain, beyond their stated spread: then parameters are named, and no effect."""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
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

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Retune:
    """The fit where the spreads of what had moved are taken RETUNE_WIDER times as wide, its parameters that left them, the shares of their
    places, by how unlikely each is where it now is, and its evidence."""

    fitted: FittedHypothesis
    parameters: tuple[str, ...]
    places: Mapping[str, float]
    score: float


def retune(case: Case, nominal: Fit) -> Retune | None:
    """The re-tune beyond the stated spread; None where no parameter leaves it.

    Only what the fit within the spread had moved is set free: each spread that is taken wider costs evidence.
    """
    moved = moved_parameters(case, nominal.hypothesis.theta, decisions.BEYOND_CHANCE)[: decisions.RETUNE_MOST]
    own = {entry.effect for entry in moved_effects(nominal, decisions.BEYOND_CHANCE)}
    if not moved and not own:
        return None
    factor = np.ones(len(case.free))
    factor[moved] = decisions.RETUNE_WIDER
    wider = _wider(case, factor, own)
    start = replace(nominal.hypothesis, theta=nominal.hypothesis.theta / factor)
    found = fit(wider, start, rounds=6)
    if found is None:
        return None
    found = fit(wider, with_process_noise(wider, found.hypothesis), rounds=6)
    if found is None:
        return None
    stated = _as_stated(found, factor, own)
    far = [
        index for index in moved_parameters(case, stated.hypothesis.theta, decisions.BEYOND_CHANCE) if index in moved
    ]
    numbers = [entry for entry in moved_effects(stated, decisions.BEYOND_CHANCE) if entry.effect in own]
    if not 0 < len(far) + len(numbers) <= decisions.RETUNE_MOST:
        return None
    names = [str(symbol) for symbol in case.library.bound.model.parameter_symbols]
    parameters = tuple(names[int(case.free[index])] for index in far)
    told = (*parameters, *(f"{entry.effect}.{entry.parameter.symbol}" for entry in numbers))
    explained = evidence(found, case.library.effects)
    score = explained - decisions.RETUNE_NATS * len(told)
    where = [*(places_of(case, name) for name in parameters), *([entry.effect.split(".")[0]] for entry in numbers)]
    distances = np.append(
        stated.hypothesis.theta[far], away(stated.hypothesis, numbers)[len(stated.hypothesis.theta) :]
    )
    places = _shares(where, distances)
    return Retune(FittedHypothesis((), stated, explained), told, places, float(score))


def _shares(where: Sequence[Sequence[str]], distances: Array) -> dict[str, float]:
    """Of the places of each number, by the nats that its distance in standard deviations costs."""
    costs = distances**2 / np.sum(distances**2)
    found: defaultdict[str, float] = defaultdict(float)
    for places, cost in zip(where, costs.tolist(), strict=True):
        for place in places:
            found[place] += cost / len(places)
    return dict(found)


def _as_stated(found: Fit, factor: Array, own: Collection[str]) -> Fit:
    """The fit of a wider case counted in the stated standard deviations."""
    numbers = np.array([decisions.RETUNE_WIDER if entry.effect in own else 1.0 for entry in found.free])
    units = np.append(factor, numbers)
    free = [replace(entry, scale=entry.scale / unit) for entry, unit in zip(found.free, numbers, strict=True)]
    return replace(
        found,
        hypothesis=replace(found.hypothesis, theta=factor * found.hypothesis.theta),
        free=tuple(free),
        information=found.information / np.outer(units, units),
        pull=found.pull / units,
    )


def _wider(case: Case, factor: Array, own: Collection[str]) -> Case:
    """The case with the coefficients' spreads times `factor` (free,), and those of the effects in `own` RETUNE_WIDER times as wide."""
    sd = case.library.bound.sd.copy()
    sd[case.free] *= factor
    stated_sd = {
        name: {s: decisions.RETUNE_WIDER * v if name in own else v for s, v in of.items()}
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
