"""Dry friction of an axis.

(1)  torque - b sgn(velocity), any value within +-b at rest
"""

from collections.abc import Iterator

from sim.edits import axis_of, speed_name, with_friction
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis, above the nominal level."""
    for axis, entry in model.places.axes.items():
        size, speed = entry.torque_size, speed_name(model, axis)
        level = axis_of(model, axis).coulomb
        yield Effect(
            name=f"{axis}.coulomb",
            depends=f"torque(sgn {speed})",
            parameters=(
                EffectParameter("b", entry.torque_unit, 0.0, size, 0.006 * size, 0.0, (0.006 * size, 0.06 * size)),
            ),
            equation=f"- b sgn({speed})",
            story="The bearing rubs with a constant force: the axis stops early and sticks until pushed hard enough.",
            source="Coulomb friction",
            prior=COMMON,
            holds_at_rest=True,
            everywhere=True,
            term="sgn(speed)",
            said="Coulomb friction",
            edit=lambda model, b, axis=axis: with_friction(model, axis, b),
            twins={f"{axis}.stribeck": "with little motion at the Stribeck speed only the level shows"},
            same_as="" if level == 0 else str(level),
        )
