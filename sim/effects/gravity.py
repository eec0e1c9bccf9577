"""A centre of gravity, a balance weight or a mounting other than the model says.

(1)  tau_gE cos(Psi)  ->  tau_gE cos(Psi + delta)
(2)  tau_gE -> tau_gE + Delta from the time t_1 on, within EDGE_S
(3)  tau_gE -> tau_gE (1 + b)
"""

from collections.abc import Iterator

import sympy

from sim.effects.edits import EDGE_S, axis_of, short, step, with_torque
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model
from sim.places import AxisPlace


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
            edit=lambda model, delta, axis=axis: _turned(model, delta, axis),
            twins={
                f"{axis}.cable_spring": "near the horizontal, both are straight in the angle",
                f"{entry.angle.removesuffix('_rad')}_sensor.offset": "gravity sees the true angle: both shift one against the other",
            },
        )
        yield from _weights(axis, entry)


def _weights(axis: str, entry: AxisPlace) -> Iterator[Effect]:
    angle, size = short(entry.angle), entry.torque_size
    yield Effect(
        name=f"{axis}.weight_shift",
        depends="torque(t)",
        parameters=(
            EffectParameter("Delta", entry.torque_unit, -0.5 * size, 0.5 * size, 0.02 * size, 0.0),
            EffectParameter("t_1", "s", 0.0, 1.0e5, 10.0),
        ),
        equation=f"gravity moment + Delta for t > t_1, over {EDGE_S:g} s",
        story="The balancing weight slipped during the run.",
        source="seed 000, balancing weight",
        edit=lambda model, Delta, t_1: _with_moment(model, Delta * step(t_1), axis),
        smooth=False,
        twins={f"{axis}.disturbance": "a push that does not end"},
    )
    yield Effect(
        name=f"{axis}.balance_weight",
        depends=f"torque({angle})",
        parameters=(EffectParameter("b", "-", -0.5, 0.5, 0.03, 0.0),),
        equation="gravity moment times (1 + b)",
        story="The balancing weight sits elsewhere than when the plant was measured.",
        source="seed 000 eq (10), counterweights",
        edit=lambda model, b: _with_moment(model, b * model.places.axes[axis].gravity_moment, axis),
        twins={f"parameters of {axis}": "identical: it is another value of the gravity moment"},
    )


def _turned(model: Model, delta: sympy.Symbol, axis: str) -> Model:
    gravity, position = model.places.axes[axis].gravity, axis_of(model, axis).position
    assert gravity is not None
    return with_torque(model, axis, gravity.xreplace({position: position + delta}) - gravity)


def _with_moment(model: Model, more: sympy.Expr, axis: str) -> Model:
    entry = model.places.axes[axis]
    assert entry.gravity is not None
    return with_torque(model, axis, entry.gravity / entry.gravity_moment * more)
