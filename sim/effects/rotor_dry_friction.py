"""Dry friction of a rotor's bearing or brushes.

(1)  omega' = ... - c sgn(omega), and no motion until c is overcome
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.effect import Effect, EffectParameter
from sim.model import Axis, Model
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each rotor whose speed is a state: it becomes an axis without a position."""
    for place, rotor in model.places.rotors.items():
        if rotor.drive is None:
            continue
        yield Effect(
            name=f"{place}.dry_friction",
            depends=f"torque(sgn omega{rotor.letter and '_' + rotor.letter})",
            parameters=(EffectParameter("c", "rad s^-2", 0.0, 2000.0, 30.0, 0.0, (30.0, 150.0)),),
            equation="omega' = ... - c sgn(omega), at rest within +-c",
            story="The rotor's bearing rubs: it starts late and runs a little slower than it should.",
            source="Coulomb friction",
            prior=COMMON,
            edit=lambda model, c, place=place: _edit(model, c, place),
            twins={
                f"{place.replace('rotor', 'input')}.deadzone": "a constant loss of torque is a constant loss of voltage, "
                "as long as the rotor turns",
                f"{place.replace('rotor', 'input')}.offset": "while the rotor keeps its direction, both take away a constant",
            },
        )


def _edit(model: Model, c: sympy.Symbol, place: str) -> Model:
    speed = model.places.rotors[place].speed
    rates = {state: rate for state, rate in model.rates.items() if state != speed}
    axis = Axis(place, None, speed, sympy.Integer(1), model.rates[speed], c, None, None)
    return replace(model, rates=rates, axes=(*model.axes, axis))
