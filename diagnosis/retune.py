"""A gap that other parameter values explain, beyond their stated spread: then parameters are named, and no effect."""

from dataclasses import dataclass, replace

import numpy as np
import sympy

from diagnosis.case import Case
from diagnosis.fit import Fit, fit
from diagnosis.notes import moved_effects, moved_parameters
from diagnosis.trial import Tried, evidence
from diagnosis.unrest import unrest_of

WIDER = 8.0
FAR = 4.0  # standard deviations
PULLED = 2.5  # by which the fit within the spread must have moved something
NATS_PER_PARAMETER = 4.0
MOST = 4


@dataclass(frozen=True, eq=False)
class Retune:
    """The fit with spreads taken WIDER times as wide, its parameters that left their spread, and its evidence."""

    tried: Tried
    parameters: tuple[str, ...]
    places: tuple[str, ...]
    score: float


def retune(case: Case, nominal: Fit) -> Retune | None:
    """The re-tune beyond the stated spread; None where no parameter leaves it, or too many do."""
    if not moved_parameters(case, nominal.supposed.theta, PULLED) and not moved_effects(nominal, PULLED):
        return None
    wider = _wider(case)
    start = replace(nominal.supposed, theta=nominal.supposed.theta / WIDER)
    found = fit(wider, start, rounds=6)
    if found is None:
        return None
    found = fit(wider, unrest_of(wider, found), rounds=6)
    if found is None:
        return None
    moved = moved_parameters(wider, found.supposed.theta, FAR / WIDER)
    own = moved_effects(found, FAR / WIDER)
    if not 0 < len(moved) + len(own) <= MOST:
        return None
    names = [str(symbol) for symbol in case.kit.bound.model.parameter_symbols]
    parameters = tuple(names[int(case.free[index])] for index in moved)
    places = [place for name in parameters for place in places_of(case, name)]
    places += [entry.effect.split(".")[0] for entry in own]
    told = (*parameters, *(f"{entry.effect}.{entry.parameter.symbol}" for entry in own))
    score = evidence(found) - NATS_PER_PARAMETER * len(told)
    return Retune(Tried((), _as_stated(found), evidence(found)), told, tuple(dict.fromkeys(places)), float(score))


def _as_stated(found: Fit) -> Fit:
    """The fit of a wider case counted in the stated standard deviations."""
    stated = np.array([entry.stated is not None for entry in found.free], dtype=bool)
    units = np.where(np.append(np.ones(len(found.supposed.theta), dtype=bool), stated), WIDER, 1.0)
    free = [replace(e, scale=e.scale / WIDER) if own else e for e, own in zip(found.free, stated, strict=True)]
    return replace(
        found,
        supposed=replace(found.supposed, theta=WIDER * found.supposed.theta),
        free=tuple(free),
        information=found.information / np.outer(units, units),
        pull=found.pull / units,
    )


def _wider(case: Case) -> Case:
    """The case with everything that its plant file states WIDER times as uncertain."""
    bound = replace(case.kit.bound, sd=case.kit.bound.sd * WIDER)
    stated_sd = {name: {s: WIDER * sd for s, sd in own.items()} for name, own in case.stated_sd.items()}
    return replace(case, kit=replace(case.kit, bound=bound), stated_sd=stated_sd)


def places_of(case: Case, coefficient: str) -> list[str]:
    """Places whose equations hold a coefficient, the nearest first."""
    model = case.kit.bound.model
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
