"""The parts of seed 001's model that its experiments excite, each with the states, inputs and parameters that it needs and no others."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import sympy
from numpy.random import Generator

from identification.model.locked import axis_beside
from records.experiment import Experiment
from sim.bind import BoundPlant
from sim.model import Axis, Model, named_symbols
from sim.plants import ce150_velagic as plant
from sim.plants.ce150 import OMEGA_M, OMEGA_T, PHI, PHI_DOT, PSI, PSI_DOT

Push = Callable[[float, float], tuple[float, float]]
Performed = Callable[[BoundPlant, Generator], Experiment]
_STOP = -named_symbols(plant.PARAMETERS)["Psi_lim"]


@cache
def arm() -> Model:
    """Eqs (3), (6), (7) with the azimuth fixed."""
    return _part("velagic_arm", {PHI: 0, PHI_DOT: 0, plant.LAG_T: 0, OMEGA_T: 0})


@cache
def turn_by_tail() -> Model:
    """Eqs (4), (6), (7) with the arm on its lower stop and the main motor off."""
    return _part("velagic_tail", {PSI: _STOP, PSI_DOT: 0, plant.LAG_M: 0, OMEGA_M: 0})


@cache
def turn_by_both() -> Model:
    """Eqs (4), (6), (7) with the arm on its lower stop."""
    return _part("velagic_both", {PSI: _STOP, PSI_DOT: 0})


@cache
def whole() -> Model:
    """All equations, with the elevation as what is read: of k_G the azimuth tells nothing."""
    model = plant.model()
    return replace(model, name="velagic_whole", outputs={"psi_rad": PSI})


def _part(name: str, held: dict[sympy.Symbol, sympy.Expr | int]) -> Model:
    """The model with the states `held` as constants; parameters that nothing holds any more are left out."""
    model = plant.model()
    rates = {state: sympy.sympify(rate).subs(held) for state, rate in model.rates.items() if state not in held}
    axes = tuple(axis_beside(axis, held) for axis in model.axes if axis.velocity not in held)
    terms = [*rates.values(), *(term for axis in axes for term in _terms(axis))]
    used = set().union(*(term.free_symbols for term in terms))
    limits = {u: pair for u, pair in model.input_limits.items() if u in used}
    used |= {symbol for pair in limits.values() for limit in pair for symbol in limit.free_symbols}
    return Model(
        name=name,
        states=tuple(state for state in model.states if state not in held),
        inputs=tuple(limits),
        outputs={output: state for output, state in model.outputs.items() if state not in held},
        parameters=tuple(spec for spec in model.parameters if used & set(spec.symbols)),
        rates=rates,
        axes=axes,
        input_limits=limits,
    )


def _terms(axis: Axis) -> list[sympy.Expr]:
    stops = [stop for stop in (axis.lower, axis.upper) if stop is not None]
    return [axis.inertia, axis.torque, axis.coulomb, *stops]
