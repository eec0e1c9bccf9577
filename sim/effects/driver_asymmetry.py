"""A driver that brakes one way and coasts the other: its gain depends on the direction.

(1)  u -> r u for u < 0
"""

from collections.abc import Iterator

import sympy

from sim.effect import Effect, EffectParameter
from sim.model import Model


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each input that takes both signs."""
    two_way = {rotor.variable for rotor in model.places.rotors.values() if rotor.two_way}
    for place, entry in model.places.inputs.items():
        u = entry.variable
        if u not in two_way:
            continue
        yield Effect(
            name=f"{place}.driver_asymmetry",
            depends=f"gain(sgn {u}) of {u}",
            parameters=(EffectParameter("r", "-", 0.0, 3.0, 0.85, 1.0),),
            equation=f"{u} -> r {u} for {u} < 0",
            story="The driver's bridge is stronger in one direction than in the other.",
            source="an H bridge that brakes one way and coasts the other",
            applied=lambda r, u=u: {u: u * (1 + (r - 1) * (1 - sympy.sign(u)) / 2)},
            twins={
                f"{place.replace('input', 'rotor')}.reverse_asymmetry": "both scale what a reversed rotor does",
                f"{place.replace('input', 'rotor')}.reverse_drag": "both change at what speed a reversed rotor turns",
            },
        )
