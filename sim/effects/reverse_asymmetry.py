"""A propeller is shaped for one direction; backwards it pushes differently.

(1)  F -> r F for omega < 0
"""

from collections.abc import Iterator

import sympy

from sim.edits import with_thrust
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each rotor that turns both ways; r = -1 reverses a thrust that the model gives the wrong sign."""
    for place, rotor in model.places.rotors.items():
        if not rotor.two_way:
            continue
        yield Effect(
            name=f"{place}.reverse_asymmetry",
            depends=f"thrust(sgn {'omega_' + rotor.letter if rotor.letter else rotor.variable})",
            parameters=(EffectParameter("r", "-", -2.0, 3.0, 0.85, 1.0, (0.7, -1.0)),),
            equation="F -> r F for omega < 0",
            story="Turning backwards, the propeller pushes with another strength than forwards.",
            source="cambered blades",
            prior=COMMON,
            edit=lambda model, r, place=place: _edit(model, r, place),
            twins={
                f"{place.replace('rotor', 'input')}.driver_asymmetry": "both scale what a reversed rotor does",
                f"{place}.reverse_drag": "a reversed rotor pushes as hard at another speed as at another strength",
            },
        )


def _edit(model: Model, r: sympy.Symbol, place: str) -> Model:
    backwards = (1 - sympy.sign(model.places.rotors[place].speed)) / 2
    return with_thrust(model, place, lambda torque: torque * (1 + (r - 1) * backwards))
