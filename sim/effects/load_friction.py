"""Friction of a bearing that carries the thrust, or is shaken by the rotor.

(1)  torque - c |omega_M| sgn(velocity)
"""

from collections.abc import Iterator

import sympy

from sim.edits import speed_name, with_friction
from sim.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis, with the rotor that is there to turn it."""
    for rotor_name, rotor in model.places.rotors.items():
        axis = model.places.pushed_by(rotor_name)
        entry, speed = model.places.axes[axis], speed_name(model, axis)
        letter = f"omega_{rotor.letter}" if rotor.letter else str(rotor.variable)
        size = entry.torque_size / rotor.speed_size
        unit = f"{entry.torque_unit} s" if rotor.letter else f"{entry.torque_unit} {_inverse(model, rotor_name)}"
        yield Effect(
            name=f"{axis}.load_friction",
            depends=f"torque({letter}, sgn {speed})",
            parameters=(EffectParameter("c", unit, 0.0, size, 0.015 * size, 0.0, (0.015 * size, 0.05 * size)),),
            equation=f"- c |{letter}| sgn({speed})",
            story="The bearing rubs more the harder the rotor pulls at it.",
            source="Coulomb friction in proportion to the bearing's load",
            holds_at_rest=True,
            edit=lambda model, c, axis=axis, rotor_name=rotor_name: with_friction(
                model, axis, c * sympy.Abs(model.places.rotors[rotor_name].speed)
            ),
            twins={
                f"{axis}.coulomb": "at a nearly constant rotor speed only the level shows",
                f"{axis}.friction_asymmetry": "both change the level of dry friction",
            },
        )


def _inverse(model: Model, rotor: str) -> str:
    variable = model.places.rotors[rotor].variable
    unit = next(entry.unit for entry in model.places.inputs.values() if entry.variable == variable)
    return "" if unit == "-" else f"{unit}^-1"
