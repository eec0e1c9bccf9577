"""What turns the azimuth of a rig that does not stand still and level.

(1)  torque - m sin(Phi - Phi_0)                the base is not level
(2)  torque + c cos(Phi - Phi_w)                a steady draught
(3)  torque + offset on any axis, written - offset
"""

from collections.abc import Iterator

import sympy

from sim.effects.edits import axis_of, short, with_torque
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model
from sim.places import AxisPlace

TURN = 3.2  # a little more than half a turn


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) on the level axis, (3) on every axis."""
    for axis, entry in model.places.axes.items():
        yield _offset(axis, entry)
        if entry.level:
            yield from _periodic(axis, entry)


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


def _periodic(axis: str, entry: AxisPlace) -> Iterator[Effect]:
    size, angle = entry.torque_size, short(entry.angle)
    same = "identical by form: one sine of the angle with a free phase"
    near = "within a half turn, a sine is nearly straight"
    yield Effect(
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
        twins={f"{axis}.wind": same, f"{axis}.cable_spring": near},
    )
    yield Effect(
        name=f"{axis}.wind",
        depends=f"torque({angle})",
        parameters=(
            EffectParameter("c", entry.torque_unit, -size, size, 0.05 * size, 0.0),
            EffectParameter("Phi_w", "rad", -TURN, TURN, 0.0, starts=(0.0, 1.57)),
        ),
        equation=f"+ c cos({angle} - Phi_w)",
        story="A steady draught in the room blows against the arm.",
        source="drag of a steady wind, to first order",
        edit=lambda model, c, Phi_w: with_torque(model, axis, c * sympy.cos(axis_of(model, axis).position - Phi_w)),
        twins={f"{axis}.tilt": same, f"{axis}.cable_spring": near},
    )
