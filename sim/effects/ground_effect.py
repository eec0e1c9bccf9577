"""A rotor near its lower stop pushes against the air that the bench throws back.

(1)  F -> F (1 + a exp(-(angle - stop) / psi_0))
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, with_thrust
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, one_way


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on the rotor that lifts an axis with a lower stop."""
    for place in model.places.rotors:
        axis = model.places.pushed_by(place)
        if model.places.axes[axis].gravity is None or axis_of(model, axis).lower is None:
            continue
        angle = model.places.axes[axis].angle.removesuffix("_rad")
        yield Effect(
            name=f"{place}.ground_effect",
            depends=f"thrust({angle})",
            parameters=(
                EffectParameter("a", "-", -0.8, 2.0, 0.05, 0.0, unlikely=one_way("an air cushion lifts")),
                EffectParameter("psi_0", "rad", 0.05, 2.0, 0.3, starts=(0.15, 0.4, 1.0)),
            ),
            equation="F -> F (1 + a exp(-(Psi + Psi_lim)/psi_0))",
            story="Low over the bench the rotor stands on its own air cushion and lifts more.",
            source="Cheeseman and Bennett, R&M 3021, 1955, as an exponential",
            prior=COMMON,
            edit=lambda model, a, psi_0, place=place, axis=axis: _edit(model, a, psi_0, place, axis),
            twins={f"{axis}.cable_spring": "near one angle both are a torque that changes with the angle"},
        )


def _edit(model: Model, a: sympy.Symbol, psi_0: sympy.Symbol, place: str, name: str) -> Model:
    axis = axis_of(model, name)
    assert axis.position is not None
    factor = 1 + a * sympy.exp(-(axis.position - axis.lower) / psi_0)
    return with_thrust(model, place, lambda torque: torque * factor)
