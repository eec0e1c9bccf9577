"""A driver that cannot give what the controller believes it can.

(1)  u -> max(-limit, min(limit, u))
"""

from collections.abc import Iterator

from sim.effects.edits import positive
from sim.effects.effect import Effect, EffectParameter
from sim.model import Model

NEVER = 30.0  # beyond every declared limit of the plants: the effect is absent


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each input."""
    for place, entry in model.places.inputs.items():
        u, size = entry.variable, entry.size
        grid = tuple(share * size for share in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9))
        yield Effect(
            name=f"{place}.saturation",
            depends=f"limit of {u}",
            parameters=(EffectParameter("limit", entry.unit, 0.05 * size, NEVER, 0.6 * size, NEVER, grid),),
            equation=f"{u} -> max(-limit, min(limit, {u}))",
            story="The driver or its supply gives out before the controller's own limit is reached.",
            source="static driver nonlinearity",
            applied=lambda limit, u=u: {u: positive(u + limit) - positive(u - limit) - limit},
            smooth=False,
        )
