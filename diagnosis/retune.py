"""A gap that other parameter values explain, beyond their stated spread: then parameters are named, and no effect."""

from dataclasses import dataclass, replace

import sympy

from diagnosis.case import Case
from diagnosis.fit import Fit, fit
from diagnosis.notes import moved_parameters
from diagnosis.search import Tried, evidence
from diagnosis.unrest import with_unrest

WIDER = 8.0
FAR = 4.0  # standard deviations
PULLED = 2.5  # by which the fit within the spread must have moved something
NATS_PER_PARAMETER = 4.0
MOST = 4


@dataclass(frozen=True, eq=False)
class Retune:
    """The fit with spreads taken WIDER times as wide, its parameters that left their spread, and its evidence."""

    case: Case
    tried: Tried
    parameters: tuple[str, ...]
    places: tuple[str, ...]
    score: float


def retune(case: Case, nominal: Fit) -> Retune | None:
    """The re-tune beyond the stated spread; None where no parameter leaves it, or too many do."""
    if not moved_parameters(case, nominal.supposed.theta, PULLED):
        return None
    bound = replace(case.kit.bound, sd=case.kit.bound.sd * WIDER)
    wider = replace(case, kit=replace(case.kit, bound=bound))
    start = replace(nominal.supposed, theta=nominal.supposed.theta / WIDER)
    found = fit(wider, start, rounds=6)
    if found is None:
        return None
    found = fit(wider, with_unrest(wider, found.supposed), rounds=6)
    if found is None:
        return None
    moved = moved_parameters(wider, found.supposed.theta, FAR / WIDER)
    if not moved or len(moved) > MOST:
        return None
    names = [str(symbol) for symbol in case.kit.bound.model.parameter_symbols]
    parameters = tuple(names[int(case.free[index])] for index in moved)
    places = tuple(dict.fromkeys(place for name in parameters for place in places_of(case, name)))
    score = evidence(found) - NATS_PER_PARAMETER * len(moved)
    return Retune(wider, Tried((), found, evidence(found)), parameters, places, float(score))


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
