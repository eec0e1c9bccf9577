"""What turns the azimuth of a rig that does not stand still and level.

(1)  torque - m sin(Phi - Phi_0)                the base is not level
(2)  torque + c s |s|, s = cos(Phi - Phi_w) - T_w Phi'      a steady draught past an arm that moves
(3)  torque + offset on any axis, written - offset
"""

from collections.abc import Iterator

import sympy

from sim.effects.edits import axis_of, short, with_torque
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model
from sim.places import AxisPlace

TURN = 6.3  # a whole turn either way: no fit that starts within half a turn is stopped


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) on the level axis, (3) on every axis."""
    for axis, entry in model.places.axes.items():
        yield _offset(axis, entry)
        if entry.level:
            yield _tilt(axis, entry)
            yield _wind(axis, entry)


def _offset(axis: str, entry: AxisPlace) -> Effect:
    size = entry.torque_size
    return Effect(
        name=f"{axis}.offset_force",
        depends="torque(1)",
        parameters=(EffectParameter("offset", entry.torque_unit, -0.5 * size, 0.5 * size, 0.02 * size, 0.0),),
        equation="- offset",
        story="Something pulls the axis one way all the time.",
        source="a constant torque",
        edit=lambda model, offset: with_torque(model, axis, -offset),
        twins={f"{axis}.friction_asymmetry": "while the axis moves, both are one constant torque"},
    )


def _tilt(axis: str, entry: AxisPlace) -> Effect:
    size, angle = entry.torque_size, short(entry.angle)
    return Effect(
        name=f"{axis}.tilt",
        depends=f"torque({angle})",
        parameters=(
            EffectParameter("m", entry.torque_unit, -size, size, 0.05 * size, 0.0),
            EffectParameter("Phi_0", "rad", -TURN, TURN, 0.0, starts=(0.0, -1.57)),
        ),
        equation=f"- m sin({angle} - Phi_0)",
        story="The base is not level: the arm wants to swing to the low side.",
        source="pendulum on a tilted base",
        edit=lambda model, m, Phi_0: with_torque(model, axis, -m * sympy.sin(axis_of(model, axis).position - Phi_0)),
        twins={
            f"{axis}.wind": "both pull to one side, and a fast wind hardly damps",
            f"{axis}.cable_spring": "within a half turn, a sine is nearly straight",
        },
    )


def _wind(axis: str, entry: AxisPlace) -> Effect:
    size, angle = entry.torque_size, short(entry.angle)
    return Effect(
        name=f"{axis}.wind",
        depends=f"torque({angle}, {angle}_dot)",
        parameters=(
            EffectParameter("c", entry.torque_unit, 0.0, size, 0.05 * size, 0.0),
            EffectParameter("Phi_w", "rad", -TURN, TURN, 0.0, starts=(-1.57, 0.0, 1.57, 3.14)),
            EffectParameter("T_w", "s", 0.0, 2.0, 0.2),
        ),
        equation=f"+ c s |s|, s = cos({angle} - Phi_w) - T_w {angle}_dot",
        story="A steady draught in the room blows against the arm.",
        source="drag of a steady wind, by the square of the stream past the arm; T_w is the arm's length by its speed",
        edit=lambda model, c, Phi_w, T_w: with_torque(model, axis, c * _stream(model, axis, Phi_w, T_w)),
        twins={
            f"{axis}.tilt": "both pull to one side, and a fast wind hardly damps",
            f"{axis}.cable_spring": "within a quarter turn, the drag's slope is nearly straight",
        },
    )


def _stream(model: Model, name: str, Phi_w: sympy.Symbol, T_w: sympy.Symbol) -> sympy.Expr:
    """The square of the stream past the arm, with its sign."""
    axis = axis_of(model, name)
    stream = sympy.cos(axis.position - Phi_w) - T_w * axis.velocity
    return stream * sympy.Abs(stream)
