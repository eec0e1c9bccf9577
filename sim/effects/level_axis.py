"""What turns the arm of a rig that does not stand still and level.

(1)  torque - m sin(Phi - Phi_0) (1 - e + e h)          the base is not level
     and on the tilting axis + e m cos(Phi - Phi_0) dh/dPsi,   h = cos(Psi) the share of its length that the arm reaches out
(2)  torque + c s |s|, s = cos(Phi - Phi_w) - T_w Phi'      a steady draught past an arm that moves
(3)  tilting axis + c cos(Phi - Phi_w)                      the same draught, which lifts the arm or presses it down
(4)  torque + offset on any axis, written - offset

Eq (1) has the potential - m cos(Phi - Phi_0) (1 - e + e h): e = 0 is the plain sine of a level arm, e = 1 a rigid arm at any height.
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, lever, short, speed_name, with_torque
from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.places import AxisPlace
from sim.prior import COMMON, Prior

TURN = 6.3  # a whole turn either way: no fit that starts within half a turn is stopped
# Joints that gravity or a driver may push at all times; a turntable is pushed by nothing, so there it is friction that differs.
JOINTS = ("pitch", "yaw", "arm", "carriage")
PUSHED = Prior(0.1, "gravity or a driver pushes such a joint at all times; plainer than what else fits as well")
PULLED = Prior(-1.9, "nothing is known to pull such an axis at all times; plainer than what else fits as well")


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) on the level axis, (3) on the one beside it that tilts, (4) on every axis."""
    for axis, entry in model.places.axes.items():
        yield _offset(axis, entry)
        if entry.level:
            yield _tilt(model, axis, entry)
            yield _wind(model, axis, entry)
            yield _lift(model, axis)


def _offset(axis: str, entry: AxisPlace) -> Effect:
    size = entry.torque_size
    return Effect(
        name=f"{axis}.offset_force",
        depends="torque(1)",
        parameters=(EffectParameter("offset", entry.torque_unit, -0.5 * size, 0.5 * size, 0.02 * size, 0.0),),
        equation="- offset",
        story="Something pulls the axis one way all the time.",
        source="a constant torque",
        prior=PUSHED if axis in JOINTS else PULLED,
        everywhere=True,
        term="constant",
        edit=lambda model, offset: with_torque(model, axis, -offset),
        twins={
            f"{axis}.friction_asymmetry": "while the axis moves, both are one constant torque",
            **({} if entry.level else {f"{axis}.wind": "while the arm hardly turns, both are a constant torque"}),
        },
    )


def _tilt(model: Model, axis: str, entry: AxisPlace) -> Effect:
    size, angle, over = entry.torque_size, short(entry.angle), model.places.axes[model.places.tilting]
    reach = lever(model, model.places.tilting)
    rises = sympy.diff(reach, axis_of(model, model.places.tilting).position)
    h, slope = (str(part).replace(over.angle, short(over.angle)) for part in (reach, rises))
    return Effect(
        name=f"{axis}.tilt",
        depends=f"torque({angle})",
        parameters=(
            EffectParameter("m", entry.torque_unit, -size, size, 0.05 * size, 0.0),
            EffectParameter("Phi_0", "rad", -TURN, TURN, 0.0, starts=(0.0, -1.57), role=Role.DIRECTION),
            EffectParameter("e", "1", 0.0, 1.0, 0.0, refining=True),
        ),
        equation=f"- m sin({angle} - Phi_0) (1 - e + e {h}), on the {model.places.tilting} + e m cos({angle} - Phi_0) ({slope})",
        story="The base is not level: the arm wants to swing to the low side.",
        source="pendulum on a tilted base",
        prior=COMMON,
        term="sin(angle)",
        edit=lambda model, m, Phi_0, e: _tilted(model, axis, m, Phi_0, e),
        twins={
            f"{axis}.wind": "both pull to one side, and a fast wind hardly damps",
            f"{axis}.cable_spring": "within a half turn, a sine is nearly straight",
        },
    )


def _tilted(model: Model, axis: str, m: sympy.Symbol, Phi_0: sympy.Symbol, e: sympy.Symbol) -> Model:
    tilting = model.places.tilting
    turned, reach = axis_of(model, axis).position - Phi_0, lever(model, tilting)
    model = with_torque(model, axis, -m * sympy.sin(turned) * (1 - e + e * reach))
    rises = sympy.diff(reach, axis_of(model, tilting).position)
    return with_torque(model, tilting, e * m * sympy.cos(turned) * rises)


def _wind(model: Model, axis: str, entry: AxisPlace) -> Effect:
    size, angle, speed = entry.torque_size, short(entry.angle), speed_name(model, axis)
    return Effect(
        name=f"{axis}.wind",
        depends=f"torque({angle}, {speed})",
        parameters=(
            EffectParameter("c", entry.torque_unit, 0.0, size, 0.05 * size, 0.0),
            EffectParameter("Phi_w", "rad", -TURN, TURN, 0.0, starts=(-1.57, 0.0, 1.57, 3.14), role=Role.DIRECTION),
            EffectParameter("T_w", "s", 0.0, 2.0, 0.2),
        ),
        equation=f"+ c s |s|, s = cos({angle} - Phi_w) - T_w {speed}",
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


def _lift(model: Model, level: str) -> Effect:
    axis, angle = model.places.tilting, short(model.places.axes[level].angle)
    size, unit = model.places.axes[axis].torque_size, model.places.axes[axis].torque_unit
    return Effect(
        name=f"{axis}.wind",
        depends=f"torque({angle})",
        parameters=(
            EffectParameter("c", unit, 0.0, size, 0.05 * size, 0.0),
            EffectParameter("Phi_w", "rad", -TURN, TURN, 0.0, starts=(-1.57, 0.0, 1.57, 3.14), role=Role.DIRECTION),
        ),
        equation=f"+ c cos({angle} - Phi_w)",
        story="A steady draught in the room lifts the arm on one side of the room and presses it down on the other.",
        source="a steady wind that does not blow level, to first order in its direction",
        edit=lambda model, c, Phi_w: with_torque(model, axis, c * sympy.cos(axis_of(model, level).position - Phi_w)),
        twins={f"{axis}.offset_force": "while the arm hardly turns, both are a constant torque"},
    )
