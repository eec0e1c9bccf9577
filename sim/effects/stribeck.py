"""Friction that is higher near rest than in motion.

(1)  torque - b_s exp(-x^2 (1 + e) / (1 + e x)) sgn(v) with x = |v| / v_s, above the nominal Coulomb level

It falls to 1/e of b_s at v_s. With e = 0 it is the bell of the literature, with a large one its plain exponential: bearings are found with
either.
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, speed_name, with_friction
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import NOTHING_NEW, Prior, Unlikely

PRIOR = Prior(-0.8, "its shapes are many, and dry friction that does not fall is among them")


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis."""
    for axis, entry in model.places.axes.items():
        size, usual, speed = entry.torque_size, entry.speed_size, speed_name(model, axis)
        yield Effect(
            name=f"{axis}.stribeck",
            depends=f"torque({speed})",
            parameters=(
                EffectParameter("b_s", entry.torque_unit, 0.0, size, 0.01 * size, 0.0, (0.01 * size, 0.05 * size)),
                EffectParameter(
                    "v_s",
                    f"{entry.length_unit} s^-1",
                    0.005 * usual,
                    2.0 * usual,
                    0.08 * usual,
                    starts=(0.03 * usual, 0.1 * usual, 0.3 * usual),
                    unlikely=Unlikely(NOTHING_NEW, "it falls beyond usual motion: dry friction", above=0.5 * usual),
                ),
                EffectParameter("e", "1", 0.0, 20.0, 0.0, starts=(0.0, 3.0), refining=True),
            ),
            equation=f"- b_s exp(-x^2 (1 + e)/(1 + e x)) sgn({speed}), x = |{speed}|/v_s",
            story="The grease holds a resting bearing more firmly than a turning one: it breaks loose with a jerk.",
            source="Armstrong, Dupont and Canudas de Wit, Automatica 30(7), 1994",
            prior=PRIOR,
            said="Stribeck friction",
            edit=lambda model, b_s, v_s, e, axis=axis: with_friction(model, axis, _level(model, axis, b_s, v_s, e)),
            twins={
                f"{axis}.coulomb": "with little motion at the Stribeck speed only the level shows",
                f"{axis}.presliding": "both hold the axis at a reversal",
            },
        )


def _level(model: Model, axis: str, b_s: sympy.Symbol, v_s: sympy.Symbol, e: sympy.Symbol) -> sympy.Expr:
    x = sympy.Abs(axis_of(model, axis).velocity) / v_s
    return b_s * sympy.exp(-(x**2) * (1 + e) / (1 + e * x))
