"""How an axis' inertia depends on an angle: the azimuth's on the elevation, that of an arm that gravity turns on its own.

(1)  inertia + J_0 + J_1 cos(Psi)^2                            a rigid body has this form
(2)  J_A cos(Psi) -> J_A (cos(Psi) + a (1 - cos(Psi)))         a = 1 is eq (15) of seed 000, against its (9)
(3)  J -> J (1 + a sin(q - q_0)),   torque - e (a / 2) J cos(q - q_0) q'^2

Eq (3) has the first harmonic of J(q). With e = 1 it is Lagrange's for the energy J q'^2 / 2; with e = 0 what is carried along gives its
speed to something else, or the model's own terms have it already.
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.edits import axis_of, short, speed_name, with_axis, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) where one axis sits on the other, (2) where the model has the bare cosine, (3) on each axis that gravity turns."""
    for axis, entry in model.places.axes.items():
        if entry.gravity is not None:
            yield _by_own_angle(model, axis)
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


def _by_own_angle(model: Model, axis: str) -> Effect:
    angle, speed = short(model.places.axes[axis].angle), speed_name(model, axis)
    return Effect(
        name=f"{axis}.varying_inertia",
        depends=f"inertia({angle})",
        parameters=(
            EffectParameter("a", "-", -0.8, 0.8, 0.1, 0.0),
            EffectParameter("q_0", "rad", -1.6, 1.6, 0.0, starts=(0.0, 1.57)),
            EffectParameter("e", "1", 0.0, 1.0, 0.0, refining=True),
        ),
        equation=f"inertia J times (1 + a sin({angle} - q_0)), torque - e (a / 2) J cos({angle} - q_0) {speed}^2",
        story="Something on the arm slides or swings as it tilts, so it is harder to turn at another height.",
        source="Lagrange's equation of an inertia that varies with the angle",
        edit=lambda model, a, q_0, e: _varied(model, axis, a, q_0, e),
        twins={f"{axis}.centre_of_gravity": "in slow motion both bend how the arm answers at another height"},
    )


def _varied(model: Model, name: str, a: sympy.Symbol, q_0: sympy.Symbol, e: sympy.Symbol) -> Model:
    axis = axis_of(model, name)
    turned, J = axis.position - q_0, axis.inertia
    model = with_torque(model, name, -e * a / 2 * J * sympy.cos(turned) * axis.velocity**2)
    return _edit(model, name, a * J * sympy.sin(turned))


def _edit(model: Model, level: str, more: sympy.Expr) -> Model:
    return with_axis(model, level, lambda axis: replace(axis, inertia=axis.inertia + more))


def _angle(model: Model) -> sympy.Expr:
    return axis_of(model, model.places.tilting).position
