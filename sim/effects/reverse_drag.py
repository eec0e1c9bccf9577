"""A propeller that turns backwards meets another drag than forwards, and so turns at another speed.

(1)  omega' = drive - r drag for omega < 0, the drag as in the plant's own equation of the speed
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each rotor that turns both ways and whose speed is a state."""
    for place, rotor in model.places.rotors.items():
        if not rotor.two_way or rotor.drive is None:
            continue
        yield Effect(
            name=f"{place}.reverse_drag",
            depends=f"torque(omega_{rotor.letter}, sgn omega_{rotor.letter})",
            parameters=(EffectParameter("r", "-", 0.2, 3.0, 1.2, 1.0),),
            equation="omega' = drive - r drag for omega < 0",
            story="Turning backwards, the propeller meets another drag than forwards: the same command turns it at another speed.",
            source="cambered blades",
            edit=lambda model, r, place=place: _edit(model, r, place),
            twins={
                f"{place}.reverse_asymmetry": "a reversed rotor pushes as hard at another speed as at another strength",
                f"{place.replace('rotor', 'input')}.driver_asymmetry": "both change at what speed a reversed rotor turns",
            },
        )


def _edit(model: Model, r: sympy.Symbol, place: str) -> Model:
    rotor = model.places.rotors[place]
    assert rotor.drive is not None
    drag = rotor.drive - model.rates[rotor.speed]
    backwards = (1 - sympy.sign(rotor.speed)) / 2
    return replace(model, rates={**model.rates, rotor.speed: rotor.drive - drag * (1 + (r - 1) * backwards)})
