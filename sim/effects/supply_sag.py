"""A supply whose voltage gives way under load: what one rotor draws is missing at both.

(1)  u -> u (1 - s (|u_M| + |u_T|) / 10 V)
"""

from collections.abc import Iterator

import sympy

from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, one_way

NOMINAL = 10.0  # [V]; scales s to a share
MOST_LOST = 0.9  # share of an input that is gone with all inputs at their full size: more would turn it round


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each input; a plant with one input has only that load."""
    load = sum((sympy.Abs(entry.variable) for entry in model.places.inputs.values()), sympy.Integer(0))
    for place, entry in model.places.inputs.items():
        u = entry.variable
        upper = MOST_LOST * NOMINAL / (entry.size * len(model.places.inputs))
        yield Effect(
            name=f"{place}.supply_sag",
            depends=f"gain({', '.join(str(i.variable) for i in model.places.inputs.values())}) of {u}",
            parameters=(
                EffectParameter(
                    "s", "-", -0.5 * upper, upper, 0.04 * NOMINAL / entry.size, 0.0, unlikely=one_way("a supply sags")
                ),
            ),
            equation=f"{u} -> {u} (1 - s (sum of |u|) / 10)",
            story="The power supply weakens under load: pushing one rotor harder leaves less for this one.",
            source="a source's inner resistance",
            prior=COMMON,
            applied=lambda s, u=u: {u: u * (1 - s * load / NOMINAL)},
            twins={f"{place}.gain": "at a nearly constant load, the loss is a constant share"},
        )
