"""Something soft on one side of an axis' way: a rubber bumper before the stop, or as far before it as a block of foam or a taut cable.

(1)  torque - k max(0, angle - (upper - a))
(2)  torque + k max(0, (lower + a) - angle)
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, positive, short, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model

FARTHEST, STARTS = 1.5, (0.05, 0.25, 0.5, 0.75)  # before the stop, in units of the angle


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) on each axis with stops."""
    for axis, entry in model.places.axes.items():
        if axis_of(model, axis).lower is not None:
            yield _one_sided(model, axis, "upper", f"- k max(0, {short(entry.angle)} - (upper - a))")
            yield _one_sided(model, axis, "lower", f"+ k max(0, lower + a - {short(entry.angle)})")


def _one_sided(model: Model, axis: str, side: str, equation: str) -> Effect:
    entry = model.places.axes[axis]
    size = entry.torque_size
    return Effect(
        name=f"{axis}.{side}_stop",
        depends=f"torque({short(entry.angle)})",
        parameters=(
            EffectParameter("k", f"{entry.torque_unit} {entry.length_unit}^-1", 0.0, 50.0 * size, size, 0.0),
            EffectParameter("a", entry.length_unit, 0.005, FARTHEST, 0.1, starts=STARTS),
        ),
        equation=equation,
        story=f"Something soft pushes it back from its {side} stop: rubber, foam or a cable that becomes taut.",
        source="a one-sided spring",
        edit=lambda model, k, a: with_torque(model, axis, k * _pressed(model, axis, side, a)),
        twins={f"{axis}.cable_spring": "where the whole flight lies within its reach, both are one spring"},
        smooth=False,
    )


def _pressed(model: Model, name: str, side: str, a: sympy.Symbol) -> sympy.Expr:
    """How far it is pressed in, towards the middle."""
    axis = axis_of(model, name)
    if side == "upper":
        return -positive(axis.position - (axis.upper - a))
    return positive(axis.lower + a - axis.position)
