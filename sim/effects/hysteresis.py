"""A cable or a bearing that gives way elastically and then slips: the torque depends on the way that the axis came.

(1)  z' = v - |v| z / z_0,   torque - k z            (Bouc-Wen's form, Dahl's model: z stays within +-z_0)
(2)  the same with k = b / z_0 and a small z_0: a bearing before it slides

What is integrated is edits.strain_rate, which is (1) but for a sweep too fast for the step of a sample.
"""

from collections.abc import Iterator

import sympy

from sim.edits import MOST_GIVEN, axis_of, short, speed_name, strain_rate, with_state, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model, symbol
from sim.prior import NOTHING_NEW, Unlikely


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) and (2) on each axis."""
    for axis, entry in model.places.axes.items():
        angle, speed, unit = short(entry.angle), speed_name(model, axis), entry.length_unit
        length = 1.0 if unit == "rad" else entry.speed_size
        size = entry.torque_size / length
        yield Effect(
            name=f"{axis}.cable_hysteresis",
            depends=f"torque({angle}, sgn {speed})",
            parameters=(
                EffectParameter("k", f"{entry.torque_unit} {unit}^-1", 0.0, 4.0 * size, 0.1 * size, 0.0),
                EffectParameter(
                    "z_0", unit, 0.05 * length, 2.0 * length, 0.2 * length, starts=(0.1 * length, 0.3 * length)
                ),
            ),
            equation=f"- k z, z' = {speed} - |{speed}| z/z_0",
            story="The cable resists a turn, then slips in its clamp; on the way back it resists the other way.",
            source="Bouc 1967, Wen 1976, with exponent 1",
            edit=lambda model, k, z_0, axis=axis: _edit(model, k, z_0, axis, "cable"),
            twins={
                f"{axis}.cable_spring": "over small angles a cable that does not slip is a spring",
                f"{axis}.coulomb": "over large angles a cable that has slipped is dry friction",
            },
        )
        yield Effect(
            name=f"{axis}.presliding",
            depends=f"torque({angle}, sgn {speed})",
            parameters=(
                EffectParameter("b", entry.torque_unit, 0.0, entry.torque_size, 0.01 * entry.torque_size, 0.0),
                EffectParameter(
                    "z_0", unit, MOST_GIVEN * length, 0.1 * length, 0.02 * length, unlikely=_bristles(length)
                ),
            ),
            equation=f"- b z/z_0, z' = {speed} - |{speed}| z/z_0",
            story="The bearing gives a little like a brush before it slides.",
            source="Dahl 1968",
            edit=lambda model, b, z_0, axis=axis: _edit(model, b / z_0, z_0, axis, "bearing"),
            twins={
                f"{axis}.coulomb": "identical but for the tiny motion before it slides",
                f"{axis}.cable_hysteresis": "identical by form, with a shorter way",
            },
        )


def _bristles(length: float) -> Unlikely:
    """What gives way no further than bristles do: a fit that ended at that bound, or within a twentieth of it."""
    return Unlikely(NOTHING_NEW, "friction near rest, which a plant leaves open", below=1.05 * MOST_GIVEN * length)


def _edit(model: Model, stiffness: sympy.Expr, z_0: sympy.Symbol, axis: str, what: str) -> Model:
    z = symbol(f"{what}_{axis}_{model.places.axes[axis].length_unit}")
    model = with_state(model, z, strain_rate(axis_of(model, axis).velocity, z, z_0))
    return with_torque(model, axis, -stiffness * z)
