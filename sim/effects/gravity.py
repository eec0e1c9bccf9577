"""A centre of gravity, a balance weight or a mounting other than the model says.

(1)  tau_gE cos(Psi)  ->  tau_gE cos(Psi + delta)
(2)  tau_gE -> tau_gE + Delta from the time t_1 on, within EDGE_S
(3)  tau_gE -> tau_gE (1 + b),   inertia J -> J (1 + j b),   on the level axis + j b J h^2,  h = cos(Psi)

Eq (3) with j = 0 is a moment alone. A weight that sits elsewhere also changes the inertia, of the azimuth by the square of how far the
arm reaches out: j is above 0 where it hangs on the heavy side, below 0 for a counterweight.
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.edits import EDGE_S, axis_of, lever, short, step, with_axis, with_torque
from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.places import AxisPlace
from sim.prior import COMMON, Prior


def effects(model: Model) -> Iterator[Effect]:
    """Eqs (1) to (3) on each axis that gravity turns."""
    for axis, entry in model.places.axes.items():
        if entry.gravity is None:
            continue
        angle = short(entry.angle)
        yield Effect(
            name=f"{axis}.centre_of_gravity",
            depends=f"torque({angle})",
            parameters=(EffectParameter("delta", "rad", -0.7, 0.7, 0.05, 0.0),),
            equation=f"gravity torque at {angle} + delta",
            story="The centre of gravity lies above or below the arm's line, so gravity pulls hardest at another angle.",
            source="seed 000 eq (11) against its (8)",
            prior=COMMON,
            term="cos(angle)",
            edit=lambda model, delta, axis=axis: _turned(model, delta, axis),
            twins={
                f"{axis}.cable_spring": "near the horizontal, both are straight in the angle",
                f"{entry.angle.removesuffix('_rad')}_sensor.offset": "gravity sees the true angle: both shift one against the other",
            },
        )
        yield from _weights(model, axis, entry)


def _weights(model: Model, axis: str, entry: AxisPlace) -> Iterator[Effect]:
    angle, size, inertia = short(entry.angle), entry.torque_size, axis_of(model, axis).inertia
    level, reach = model.places.level, str(lever(model, axis)).replace(entry.angle, angle)
    beside = f", that of the {level} + j b J {reach}^2" if level else ""
    yield Effect(
        name=f"{axis}.weight_shift",
        depends="torque(t)",
        parameters=(
            EffectParameter("Delta", entry.torque_unit, -0.5 * size, 0.5 * size, 0.02 * size, 0.0),
            EffectParameter("t_1", "s", 0.0, 1.0e5, 10.0, role=Role.INSTANT),
        ),
        equation=f"gravity moment + Delta for t > t_1, over {EDGE_S:g} s",
        story="The balancing weight slipped during the run.",
        source="seed 000, balancing weight",
        prior=COMMON,
        needs_gravity=True,
        edit=lambda model, Delta, t_1: _with_moment(model, Delta * step(t_1), axis),
        smooth=False,
        twins={f"{axis}.disturbance": "a push that does not end"},
    )
    yield Effect(
        name=f"{axis}.balance_weight",
        depends=f"torque({angle})",
        parameters=(
            EffectParameter("b", "-", -0.5, 0.5, 0.03, 0.0),
            EffectParameter("j", "-", -0.7, 0.7, 0.0, refining=True),
        ),
        equation=f"gravity moment times (1 + b), inertia J times (1 + j b){beside}",
        story="The balancing weight sits elsewhere than when the plant was measured.",
        source="seed 000 eq (10), counterweights",
        prior=Prior(-5.0, "possible, and a parameter of the plant under another name"),
        edit=lambda model, b, j: _reweighted(model, b, j * b * inertia, axis),
        twins={f"parameters of {axis}": "identical: it is another value of the gravity moment and of the inertia"},
    )


def _reweighted(model: Model, b: sympy.Symbol, inertia: sympy.Expr, axis: str) -> Model:
    model = _with_moment(model, b * model.places.axes[axis].gravity_moment, axis)
    model = with_axis(model, axis, lambda tilting: replace(tilting, inertia=tilting.inertia + inertia))
    if not model.places.level:
        return model
    further = inertia * lever(model, axis) ** 2
    return with_axis(model, model.places.level, lambda level: replace(level, inertia=level.inertia + further))


def _turned(model: Model, delta: sympy.Symbol, axis: str) -> Model:
    gravity, position = model.places.axes[axis].gravity, axis_of(model, axis).position
    assert gravity is not None
    return with_torque(model, axis, gravity.xreplace({position: position + delta}) - gravity)


def _with_moment(model: Model, more: sympy.Expr, axis: str) -> Model:
    return with_torque(model, axis, -lever(model, axis) * more)
