"""Air resistance of the moving arm.

(1)  torque - c |v| v
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, speed_name, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, one_way


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis."""
    for axis, entry in model.places.axes.items():
        size, speed = entry.torque_size / entry.speed_size**2, speed_name(model, axis)
        yield Effect(
            name=f"{axis}.quadratic_drag",
            depends=f"torque({speed})",
            parameters=(
                EffectParameter(
                    "c",
                    f"{entry.torque_unit} s^2 {entry.length_unit}^-2",
                    -0.2 * size,
                    2.0 * size,
                    0.04 * size,
                    0.0,
                    unlikely=one_way("air brakes"),
                ),
            ),
            equation=f"- c |{speed}| {speed}",
            story="The air resists the motion, four times as much at twice the speed.",
            source="drag of a bluff body",
            prior=COMMON,
            term="abs(speed) speed",
            edit=lambda model, c, axis=axis: _edit(model, c, axis),
            twins={f"{model.places.rotor_of(axis)}.axial_inflow": "both damp fast motion more"},
        )


def _edit(model: Model, c: sympy.Symbol, axis: str) -> Model:
    velocity = axis_of(model, axis).velocity
    return with_torque(model, axis, -c * sympy.Abs(velocity) * velocity)
