"""A driver that cannot give what the controller believes it can.

(1)  u -> max(-limit, min(limit, u)), its corner rounded over limit (1 -+ w)
"""

from collections.abc import Iterator

import sympy

from sim.edits import SHARP, knee
from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.prior import COMMON

# Where the limit is no limit, and the effect absent: beyond what the plants here declare, in an input's own unit, and where a usual command
# is larger than that, a quarter beyond it. Nothing is decided by how far.
NEVER = 30.0
BEYOND = 1.25
# The least limit, as a share of the input's size: slow rigs are driven by little of what their driver gives (EMPS of 10 V by 0.3 V), and
# it may end within.
LEAST = 0.002

# Of a corner, as a share of where it lies.
ROUNDING = EffectParameter("w", "1", 0.0, 0.35, 0.0, None, (0.0, 0.2), refining=True)


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each input."""
    for place, entry in model.places.inputs.items():
        u, size = entry.variable, entry.size
        never = max(NEVER, BEYOND * size)
        grid = tuple(share * size for share in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9))
        yield Effect(
            name=f"{place}.saturation",
            depends=f"limit of {u}",
            parameters=(
                EffectParameter("limit", entry.unit, LEAST * size, never, 0.6 * size, never, grid, role=Role.LEVEL),
                ROUNDING,
            ),
            equation=f"{u} -> max(-limit, min(limit, {u})), its corner rounded over limit (1 -+ w)",
            story="The driver or its supply gives out before the controller's own limit is reached.",
            source="static driver nonlinearity",
            prior=COMMON,
            applied=lambda limit, w, u=u: {u: u - sympy.sign(u) * knee(sympy.Abs(u) - limit, w * limit + SHARP)},
            smooth=False,
        )
