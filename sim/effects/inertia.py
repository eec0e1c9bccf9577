"""How the azimuth's inertia depends on the elevation.

(1)  inertia + J_0 + J_1 cos(Psi)^2                            a rigid body has this form
(2)  J_A cos(Psi) -> J_A (cos(Psi) + a (1 - cos(Psi)))         a = 1 is eq (15) of seed 000, against its (9)
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.edits import axis_of, short, with_axis
from sim.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) where one axis sits on the other, (2) where the model has the bare cosine."""
    level, tilting = model.places.level, model.places.tilting
    if not level:
        return
    entry = model.places.axes[level]
    angle, unit, size = short(model.places.axes[tilting].angle), f"{entry.torque_unit} s^2", 0.1 * entry.torque_size
    yield Effect(
        name=f"{level}.inertia_shape",
        depends=f"inertia({angle})",
        parameters=(
            EffectParameter("J_1", unit, -0.5 * size, 10.0 * size, 0.3 * size, 0.0),
            EffectParameter("J_0", unit, -0.3 * size, 10.0 * size, 0.0, 0.0),
        ),
        equation=f"inertia + J_0 + J_1 cos({angle})^2",
        story="The arm is harder or easier to turn at another height than the model says.",
        source="rigid body",
        edit=lambda model, J_1, J_0: _edit(model, level, J_0 + J_1 * sympy.cos(_angle(model)) ** 2),
        twins={f"{level}.coriolis": "both make the azimuth's inertia depend on the elevation"},
    )
    cosine = sympy.cos(_angle(model))
    whole = axis_of(model, level).inertia / cosine
    if whole.is_Symbol:
        yield Effect(
            name=f"{level}.inertia_without_cosine",
            depends=f"inertia({angle})",
            parameters=(EffectParameter("a", "-", -1.0, 2.0, 0.5, 0.0),),
            equation=f"inertia + a {whole} (1 - cos({angle}))",
            story="The arm is as hard to turn when it points up as when it is level.",
            source="seed 000 eq (15), against its (9)",
            edit=lambda model, a: _edit(model, level, a * whole * (1 - cosine)),
            twins={f"{level}.inertia_shape": "both make the azimuth's inertia depend on the elevation"},
        )


def _edit(model: Model, level: str, more: sympy.Expr) -> Model:
    return with_axis(model, level, lambda axis: replace(axis, inertia=axis.inertia + more))


def _angle(model: Model) -> sympy.Expr:
    return axis_of(model, model.places.tilting).position
