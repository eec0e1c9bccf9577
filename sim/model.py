"""A plant as symbolic equations, from which everything else is derived: reference, kernels, Jacobians, linearisation."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy

from sim.places import Places
from sim.symbolic.slopes import corners_of

TIME = sympy.Symbol("t_s", real=True)


@dataclass(frozen=True)
class ParameterSpec:
    """What a model demands of one parameter: `count` coefficients (1 is a plain number), its unit and its sign.

    `unit` follows the plant file: "[N, N s]" gives one unit per coefficient. `sign` is "positive" (> 0), "non-negative" or "any"
    and holds for every coefficient.
    """

    name: str
    count: int
    unit: str
    sign: str = "any"

    @property
    def symbols(self) -> tuple[sympy.Symbol, ...]:
        """The coefficients as symbols: K_M, or p_bM_0, p_bM_1, ..."""
        if self.count == 1:
            return (sympy.Symbol(self.name, real=True),)
        return tuple(sympy.Symbol(f"{self.name}_{index}", real=True) for index in range(self.count))


@dataclass(frozen=True)
class Axis:
    """One mechanical degree of freedom with dry friction and hard stops.

    d(velocity)/dt is `acceleration` of its torque, `friction` and inertia; at rest the friction takes any value within +-coulomb.
    `coulomb` may depend on the friction's direction (Model.friction_signs). `lower` and `upper` are the stops of `position`, hit
    without rebound; None where there is none. A rotor with dry friction is an axis without a position. All are SI: N m and kg m^2 of a
    turning axis, N and kg of a sliding one.
    """

    name: str
    position: sympy.Symbol | None
    velocity: sympy.Symbol
    inertia: sympy.Expr
    torque: sympy.Expr
    coulomb: sympy.Expr
    lower: sympy.Expr | None
    upper: sympy.Expr | None

    def friction(self, sign: sympy.Expr) -> sympy.Expr:
        """What dry friction in the direction `sign` (+-1, or 0 to leave it out) takes from the torque: coulomb * sign."""
        return sympy.sympify(self.coulomb) * sign


def acceleration(torque: Any, friction: Any, inverse_inertia: Any) -> Any:
    """d(velocity)/dt = (torque - friction) / inertia of an axis in motion, over whatever has these operators: SymPy or C text."""
    return (torque - friction) * inverse_inertia


@dataclass(frozen=True, eq=False)
class Model:
    """A plant's equations: states x with rates, inputs u clamped to `input_limits`, outputs y, parameters p; argument order (t, x, u, p).

    `rates` covers every state but the velocities of `axes`, whose rates follow from the axes. `signals` are further quantities
    that a log of the plant may carry (the speed of a rotor that has no state), by column name. `places` says where effects can act,
    `starts` where the states that effects brought, the last of `states`, begin: at 0 or where another state is. `switches` are those of
    the parameters that are 1, or 0 to leave out the terms that vanish with them; the equations have no slopes by them. `sleepers` are
    states that stand still and move nothing while the switch beside them is 0. `second_s` is how long the plant takes for what a rig of
    the table does in a second (sim/equations/pace.py).
    """

    name: str
    states: tuple[sympy.Symbol, ...]
    inputs: tuple[sympy.Symbol, ...]
    outputs: Mapping[str, sympy.Expr]
    parameters: tuple[ParameterSpec, ...]
    rates: Mapping[sympy.Symbol, sympy.Expr]
    axes: tuple[Axis, ...]
    input_limits: Mapping[sympy.Symbol, tuple[sympy.Expr, sympy.Expr]]
    signals: Mapping[str, sympy.Expr] = field(default_factory=dict)
    places: Places = field(default_factory=Places)
    starts: Mapping[sympy.Symbol, sympy.Expr] = field(default_factory=dict)
    switches: tuple[sympy.Symbol, ...] = ()
    sleepers: Mapping[sympy.Symbol, sympy.Symbol] = field(default_factory=dict)
    second_s: float = 1.0

    @cached_property
    def parameter_symbols(self) -> tuple[sympy.Symbol, ...]:
        """All coefficients in the order of the parameter vector p."""
        return tuple(symbol for spec in self.parameters for symbol in spec.symbols)

    def limits(self, variable: sympy.Symbol) -> tuple[sympy.Expr, sympy.Expr]:
        """The least and the largest value of an input: without end where the model states none."""
        return self.input_limits.get(variable, (-sympy.oo, sympy.oo))

    @cached_property
    def axis_states(self) -> frozenset[str]:
        """The names of the states that are an axis' position or velocity."""
        states = (state for axis in self.axes for state in (axis.position, axis.velocity))
        return frozenset(str(state) for state in states if state is not None)

    @property
    def friction_signs(self) -> tuple[sympy.Symbol, ...]:
        """One symbol per axis for the direction of its dry friction: sgn(velocity), or 0 where it is left out."""
        return tuple(sympy.Symbol(f"sign_{axis.name}", real=True) for axis in self.axes)

    @cached_property
    def kinks(self) -> tuple[sympy.Symbol, ...]:
        """States at whose zero the rates have a kink or a step (|w|, sgn w): the kernel ends a step there, to keep its order."""
        rates = [*self.rates.values(), *(term for axis in self.axes for term in (axis.torque, axis.inertia))]
        bent = {corner for rate in rates for corner in corners_of(sympy.sympify(rate))}
        velocities = {axis.velocity for axis in self.axes}
        return tuple(state for state in self.states if state in bent - velocities)

    def state_rates(self) -> sympy.Matrix:
        """dx/dt as a column (states,) in the order of `states`, with the friction directions as symbols."""
        rates = dict(self.rates)
        for axis, sign in zip(self.axes, self.friction_signs, strict=True):
            rates[axis.velocity] = acceleration(axis.torque, axis.friction(sign), 1 / sympy.sympify(axis.inertia))
        return sympy.Matrix([rates[state] for state in self.states])


def symbol(name: str) -> sympy.Symbol:
    """A real symbol: the assumption lets SymPy differentiate |w|."""
    return sympy.Symbol(name, real=True)


def named_symbols(specs: tuple[ParameterSpec, ...]) -> dict[str, Any]:
    """Parameter name -> its symbol, or the tuple of its coefficients' symbols."""
    return {spec.name: spec.symbols if spec.count > 1 else spec.symbols[0] for spec in specs}


def polynomial(coefficients: tuple[sympy.Symbol, ...], argument: sympy.Expr) -> sympy.Expr:
    """sum_i c_i argument^i, nested as Horner does."""
    result = sympy.Integer(0)
    for coefficient in reversed(coefficients):
        result = coefficient + argument * result
    return result


def odd_polynomial(coefficients: tuple[sympy.Symbol, ...], argument: sympy.Expr) -> sympy.Expr:
    """The odd extension sgn(w) sum_i c_i |w|^i, written so that it is smooth at 0 where c_0 is 0."""
    constant, *higher = coefficients
    return constant * sympy.sign(argument) + argument * polynomial(tuple(higher), sympy.Abs(argument))
