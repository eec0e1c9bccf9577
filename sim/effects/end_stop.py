"""A soft bumper before a hard stop.

(1)  torque - k max(0, angle - (upper - a)) + k max(0, (lower + a) - angle)
"""

from collections.abc import Iterator

import sympy

from sim.effects.edits import axis_of, positive, short, with_torque
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis with stops."""
    for axis, entry in model.places.axes.items():
        if axis_of(model, axis).lower is None:
            continue
        size = entry.torque_size
        yield Effect(
            name=f"{axis}.end_stop",
            depends=f"torque({short(entry.angle)})",
            parameters=(
                EffectParameter("k", f"{entry.torque_unit} {entry.length_unit}^-1", 0.0, 50.0 * size, size, 0.0),
                EffectParameter("a", entry.length_unit, 0.005, 0.6, 0.1, starts=(0.05, 0.15, 0.3)),
            ),
            equation="- k times the way into a bumper of thickness a before each stop",
            story="A rubber bumper before the stop pushes the arm back.",
            source="a one-sided spring",
            edit=lambda model, k, a, axis=axis: _edit(model, k, a, axis),
            smooth=False,
        )


def _edit(model: Model, k: sympy.Symbol, a: sympy.Symbol, name: str) -> Model:
    axis = axis_of(model, name)
    above = positive(axis.position - (axis.upper - a))
    below = positive(axis.lower + a - axis.position)
    return with_torque(model, name, k * (below - above))
