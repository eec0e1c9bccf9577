"""A rotor that is carried through the air along its axis loses thrust: it damps the motion, the more the faster it turns.

(1)  torque - c |omega| velocity
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, speed_name, with_torque
from sim.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) for each rotor on the axis that it is there to turn."""
    for place, rotor in model.places.rotors.items():
        if rotor.linear:
            continue
        axis = model.places.pushed_by(place)
        entry = model.places.axes[axis]
        unit = 0.3 * entry.torque_size / rotor.speed_size
        speed = speed_name(model, axis)
        yield Effect(
            name=f"{place}.axial_inflow",
            depends=f"thrust(omega_{rotor.letter}, {speed})",
            parameters=(EffectParameter("c", f"{entry.torque_unit} s^2", -20.0 * unit, 20.0 * unit, unit, 0.0),),
            equation=f"torque on {axis} - c |omega_{rotor.letter}| {speed}",
            story="A propeller moving along its own axis meets more air from ahead and pushes less: it brakes the motion.",
            source="blade element theory, to first order in the inflow",
            edit=lambda model, c, place=place, axis=axis: with_torque(
                model, axis, -c * sympy.Abs(model.places.rotors[place].speed) * axis_of(model, axis).velocity
            ),
            twins={
                f"{axis}.quadratic_drag": "both damp fast motion more",
                f"parameters of {axis}": "at a nearly constant rotor speed it is viscous friction",
            },
        )
