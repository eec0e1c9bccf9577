"""A rotor out of balance shakes the axis that it pushes.

(1)  torque + c omega^2 sin(theta),   theta' = omega
(2)  y = angle - a sin(theta),   c = a J,  J the axis' inertia

Eq (2) is what (1) comes to where omega changes little within a turn: it shakes an axis that moves by the same angle at every speed.
It stands for (1) because steps of a sample are as long as a turn, and no sum over them would be its integral. That shaking also eases
dry friction is left out.
"""

from collections.abc import Iterator

import sympy

from sim.edits import short, with_output, with_state
from sim.effect import Effect, EffectParameter
from sim.model import Model, symbol


def effects(model: Model) -> Iterator[Effect]:
    """Eq (2) on each rotor whose speed is a state, where the angle of its axis is measured."""
    for place, rotor in model.places.rotors.items():
        if rotor.drive is None:
            continue
        axis = model.places.pushed_by(place)
        entry = model.places.axes[axis]
        if entry.angle not in model.outputs:
            continue
        length = 1.0 if entry.length_unit == "rad" else entry.speed_size
        yield Effect(
            name=f"{place}.imbalance",
            depends=f"torque(omega_{rotor.letter}, t)",
            parameters=(EffectParameter("a", entry.length_unit, 0.0, 0.05 * length, 1e-3 * length, 0.0),),
            equation=f"y = {short(entry.angle)} - a sin(theta), theta' = omega_{rotor.letter}",
            story="The rotor is out of balance and shakes the arm once with each of its turns.",
            source="centrifugal force of an eccentric mass: + c omega^2 sin(theta) on an axis of inertia c / a",
            edit=lambda model, a, place=place, axis=axis: _edit(model, a, place, axis),
            repeats=False,
        )


def _edit(model: Model, a: sympy.Symbol, place: str, axis: str) -> Model:
    theta = symbol(f"turn_{place}_rad")
    model = with_state(model, theta, model.places.rotors[place].speed)
    return with_output(model, model.places.axes[axis].angle, lambda output: output - a * sympy.sin(theta))
