"""Dry friction that gives way before it slides: what stands for a bearing with a soft seal, and for a simulation by Dahl or LuGre.

(1)  torque - b_c z / z_0,   z' = v - |v| z / z_0          (Dahl 1968), in place of - b_c sgn(v)

b_c is all dry friction of the axis, its own and what effects add; none of it sticks then. z_0 is a few encoder steps at most; what gives
way further has a name, `presliding`.
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.edits import MOST_GIVEN, NEGLIGIBLE, axis_of, short, sign_of, speed_name, strain_rate, with_axis, with_state
from sim.effect import Effect, EffectParameter
from sim.model import Model, symbol


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis that has friction as stated."""
    for axis, entry in model.places.axes.items():
        if axis_of(model, axis).coulomb == 0:
            continue
        angle, speed, unit = short(entry.angle), speed_name(model, axis), entry.length_unit
        length = 1.0 if unit == "rad" else entry.speed_size
        yield Effect(
            name=f"{axis}.bristles",
            depends=f"torque({angle}, sgn {speed})",
            parameters=(EffectParameter("z_0", unit, 0.0, MOST_GIVEN * length, 0.002 * length, 0.0),),
            equation=f"- b_c z/z_0, z' = {speed} - |{speed}| z/z_0",
            story="A pushed axis does not stick: it gives a little like a brush, and springs back, until it slides.",
            source="Dahl 1968",
            edit=lambda model, z_0, axis=axis: _edit(model, z_0, axis),
            names_a_gap=False,
        )


def _edit(model: Model, z_0: sympy.Symbol, name: str) -> Model:
    z = symbol(f"bristles_{name}_{model.places.axes[name].length_unit}")
    way = z_0 + NEGLIGIBLE
    present = z_0 / way
    model = with_state(model, z, present * strain_rate(axis_of(model, name).velocity, z, way))
    # Where friction depends on its direction, the bristles' stretch stands for that: dry friction that is gone has none.
    level = sympy.sympify(axis_of(model, name).coulomb).xreplace({sign_of(model, name): z / way})
    return with_axis(
        model,
        name,
        lambda axis: replace(
            axis, torque=axis.torque - present * level * z / way, coulomb=axis.coulomb * (1 - present)
        ),
    )
