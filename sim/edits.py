"""Changes of a plant's equations, each a function from model to model."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import sympy

from records.text.units import stem
from sim.model import TIME, Axis, Model
from sim.places import AxisPlace, Edit

Expression = Any
NEGLIGIBLE = 1e-30  # beside the square of the sharpest corner
# Of what gives near rest, in rad or in units of the way that is usual in a second: what gives way further has a name.
MOST_GIVEN = 0.01
SHARP = 1e-9  # V: the least width of a corner of what arrives of an input
SETTLING_S = 0.008  # the shortest time in which a strain settles
EDGE_S = 0.02  # how long a step in time takes: a bend is integrated well and has derivatives, a jump has none


def axis_of(model: Model, name: str) -> Axis:
    """The axis of that name."""
    return next(axis for axis in model.axes if axis.name == name)


def with_position(model: Model) -> dict[str, AxisPlace]:
    """The places of axes that have a position; one that turns freely may have its speed alone, and then no spring knows where it is."""
    return {name: entry for name, entry in model.places.axes.items() if axis_of(model, name).position is not None}


def sign_of(model: Model, name: str) -> sympy.Symbol:
    """The symbol of the direction of that axis' dry friction."""
    return next(sign for axis, sign in zip(model.axes, model.friction_signs, strict=True) if axis.name == name)


def with_axis(model: Model, name: str, change: Callable[[Axis], Axis]) -> Model:
    """One axis changed."""
    return replace(model, axes=tuple(change(axis) if axis.name == name else axis for axis in model.axes))


def with_torque(model: Model, name: str, torque: Expression) -> Model:
    """A further torque (force) on an axis."""
    return with_axis(model, name, lambda axis: replace(axis, torque=axis.torque + torque))


def with_friction(model: Model, name: str, level: Expression) -> Model:
    """Further dry friction on an axis; at rest it takes any value within its level."""
    return with_axis(model, name, lambda axis: replace(axis, coulomb=axis.coulomb + level))


def with_thrust(model: Model, rotor: str, edit: Edit) -> Model:
    """A rotor's torques replaced by `edit` of them, on every axis that it pushes."""
    place = model.places.rotors[rotor]
    thrusts = {axis: edit(torque) for axis, torque in place.thrusts.items()}
    for axis, torque in place.thrusts.items():
        model = with_torque(model, axis, thrusts[axis] - torque)
    rotors = {**model.places.rotors, rotor: replace(place, thrusts=thrusts)}
    return replace(model, places=replace(model.places, rotors=rotors))


def with_drive(model: Model, rotor: str, factor: Expression) -> Model:
    """What drives a rotor times `factor`: the input's part of its rate, or the input itself where the rotor has no lag."""
    place = model.places.rotors[rotor]
    if place.drive is None:
        return with_thrust(model, rotor, lambda torque: torque.xreplace({place.variable: factor * place.variable}))
    rate = model.rates[place.speed] + (factor - 1) * place.drive
    rotors = {**model.places.rotors, rotor: replace(place, drive=factor * place.drive)}
    return replace(model, rates={**model.rates, place.speed: rate}, places=replace(model.places, rotors=rotors))


def with_input(model: Model, applied: Mapping[sympy.Symbol, Expression]) -> Model:
    """Each input replaced by what arrives of it, in every equation."""

    def edit(expression: Expression) -> Expression:
        return sympy.sympify(expression).xreplace(dict(applied))

    return replace(
        model,
        rates={state: edit(rate) for state, rate in model.rates.items()},
        axes=tuple(
            replace(axis, inertia=edit(axis.inertia), torque=edit(axis.torque), coulomb=edit(axis.coulomb))
            for axis in model.axes
        ),
        signals={name: edit(signal) for name, signal in model.signals.items()},
        places=model.places.edited(edit),
    )


def with_output(model: Model, output: str, edit: Edit) -> Model:
    """One output replaced by `edit` of it."""
    return replace(model, outputs={**model.outputs, output: edit(model.outputs[output])})


def with_state(model: Model, state: sympy.Symbol, rate: Expression, start: sympy.Symbol | None = None) -> Model:
    """A further state with its rate, which starts at 0 or where another state is."""
    starts = {**model.starts, state: sympy.Integer(0) if start is None else start}
    return replace(model, states=(*model.states, state), rates={**model.rates, state: rate}, starts=starts)


def positive(expression: Expression) -> Expression:
    """The expression where it is above 0, else 0: max(expression, 0) in a form that SymPy handles fast."""
    return expression * sympy.Heaviside(expression)


def knee(expression: Expression, width: Expression) -> Expression:
    """`positive` with its corner rounded by a parabola over +-width: (x + width)^2 / (4 width) there; the width must not be 0.

    Its reciprocal is width / (width^2 + NEGLIGIBLE), known to be real whatever its symbols are: SymPy else searches whole equations for
    imaginary parts, minutes long once several effects act on one input.
    """
    beyond = positive(expression - width)
    return beyond + (positive(expression + width) - beyond) ** 2 * width / (4 * (width**2 + NEGLIGIBLE))


def strain_rate(velocity: Expression, z: sympy.Symbol, z_0: Expression) -> Expression:
    """z' = (v - |v| z / z_0) / sqrt(1 + (|v| T / z_0)^2), T = SETTLING_S: the strain of what gives way until |z| = z_0 (Dahl 1968).

    Without the root it would, at a fast sweep, where z has long been at its end, be too stiff for the step of a sample.
    """
    rate = sympy.Abs(velocity) / z_0
    return (velocity - rate * z) / sympy.sqrt(1 + (SETTLING_S * rate) ** 2)


def lever(model: Model, name: str) -> Expression:
    """How far out an axis that gravity turns holds its weight, as a share of the furthest: cos(psi) of an arm that is level at 0."""
    place = model.places.axes[name]
    assert place.gravity is not None
    return -place.gravity / place.gravity_moment


def step(at_s: Expression) -> Expression:
    """0 before the time `at_s` and 1 after it, straight in between over EDGE_S, half way up at `at_s`."""
    way = (TIME - at_s) / EDGE_S + sympy.Rational(1, 2)
    return positive(way) - positive(way - 1)


def speed_name(model: Model, name: str) -> str:
    """An axis' speed as classes and equations write it: psi_dot of an axis at psi_rad, and its own symbol (omega) without a position."""
    axis = axis_of(model, name)
    return short(str(axis.velocity)) if axis.position is None else f"{short(model.places.axes[name].angle)}_dot"


def short(name: str) -> str:
    """A column without its unit: psi of psi_rad."""
    return stem(name)
