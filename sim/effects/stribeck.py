"""Friction that is higher near rest than in motion.

(1)  torque - b_s exp(-(v / v_s)^2) sgn(v), above the nominal Coulomb level
"""

from collections.abc import Iterator

import sympy

from sim.effects.edits import axis_of, short, with_friction
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis."""
    for axis, entry in model.places.axes.items():
        size, speed, angle = entry.torque_size, entry.speed_size, short(entry.angle)
        yield Effect(
            name=f"{axis}.stribeck",
            depends=f"torque({angle}_dot)",
            parameters=(
                EffectParameter("b_s", entry.torque_unit, 0.0, size, 0.01 * size, 0.0, (0.01 * size, 0.05 * size)),
                EffectParameter(
                    "v_s",
                    f"{entry.length_unit} s^-1",
                    0.005 * speed,
                    2.0 * speed,
                    0.08 * speed,
                    starts=(0.03 * speed, 0.1 * speed, 0.3 * speed),
                ),
            ),
            equation=f"- b_s exp(-({angle}'/v_s)^2) sgn({angle}')",
            story="The grease holds a resting bearing more firmly than a turning one: it breaks loose with a jerk.",
            source="Armstrong, Dupont and Canudas de Wit, Automatica 30(7), 1994",
            edit=lambda model, b_s, v_s, axis=axis: with_friction(
                model, axis, b_s * sympy.exp(-((axis_of(model, axis).velocity / v_s) ** 2))
            ),
            twins={
                f"{axis}.coulomb": "with little motion at the Stribeck speed only the level shows",
                f"{axis}.presliding": "both hold the axis at a reversal",
            },
        )
