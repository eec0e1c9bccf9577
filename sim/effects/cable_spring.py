"""A cable that is bent pulls back, the harder the further it is bent.

(1)  torque - k x (1 + h x^2),  x = angle - angle_0

Eq (1) with h = 0 is Hooke's law; a cable near the end of its slack is stiffer, and a straight spring would leave that to other effects.
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, short, with_position, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, one_way


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis."""
    for axis, entry in with_position(model).items():
        angle, unit = short(entry.angle), entry.length_unit
        size = entry.torque_size / (1.0 if unit == "rad" else entry.speed_size)
        twins = {f"{axis}.cable_hysteresis": "over small angles a cable that does not slip is a spring"}
        if entry.level:
            twins |= {
                f"{axis}.tilt": "within a half turn, sin(angle) is nearly straight",
                f"{axis}.wind": "within a quarter turn, the drag's slope is nearly straight",
            }
        elif entry.gravity is not None:
            twins |= {f"{axis}.centre_of_gravity": "near the horizontal, both are straight in the angle"}
        yield Effect(
            name=f"{axis}.cable_spring",
            depends=f"torque({angle})",
            parameters=(
                EffectParameter(
                    "k",
                    f"{entry.torque_unit} {unit}^-1",
                    -0.5 * size,
                    2.0 * size,
                    0.05 * size,
                    0.0,
                    unlikely=one_way("a spring pulls back"),
                ),
                EffectParameter("angle_0", unit, -4.0, 4.0, 0.0, starts=(0.0, -0.5, 0.5)),
                EffectParameter("h", f"{unit}^-2", 0.0, 1.0, 0.0, None, (0.1,), refining=True),
            ),
            equation=f"- k x (1 + h x^2), x = {angle} - angle_0",
            story="The cables to the moving part bend and pull it back to one angle.",
            source="Hooke's law; the cubic term is that of Duffing's spring",
            prior=COMMON,
            term="angle",
            edit=lambda model, k, angle_0, h, axis=axis: with_torque(
                model, axis, -k * _bent(axis_of(model, axis).position - angle_0, h)
            ),
            twins=twins,
        )


def _bent(x: sympy.Expr, h: sympy.Symbol) -> sympy.Expr:
    return x * (1 + h * x**2)
