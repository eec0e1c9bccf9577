"""Dead band of a driver: a small command moves nothing, and of a large one the band is missing.

(1)  u -> sgn(u) max(|u| - d, 0), its corner rounded over d (1 -+ w)
"""

from collections.abc import Iterator

import sympy

from sim.edits import SHARP, knee
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each input."""
    for place, entry in model.places.inputs.items():
        u = entry.variable
        yield Effect(
            name=f"{place}.deadzone",
            depends=f"dead band of {u}",
            parameters=(
                EffectParameter("d", entry.unit, 0.0, 0.4 * entry.size, 0.02 * entry.size, 0.0, _starts(entry.size)),
                EffectParameter("w", "1", 0.0, 3.0, 0.0, None, (0.5,), refining=True),
            ),
            equation=f"{u} -> sgn({u}) max(|{u}| - d, 0), its corner rounded over d (1 -+ w)",
            story="The driver ignores small commands, so the plant always gets a little less than it was told.",
            source="static driver nonlinearity (H bridge, dry motor)",
            prior=COMMON,
            applied=lambda d, w, u=u: {u: sympy.sign(u) * _passed(sympy.Abs(u), d, w * d + SHARP)},
            twins={
                f"{place}.offset": "while the input keeps its sign, both take away a constant",
                f"{place}.gain": "over a narrow range of inputs, a constant loss looks like a smaller gain",
            },
        )


def _passed(size: sympy.Expr, d: sympy.Symbol, width: sympy.Expr) -> sympy.Expr:
    """What is left of an input's size; nothing of 0, however round the corner is."""
    return knee(size - d, width) - knee(-d, width)


def _starts(size: float) -> tuple[float, ...]:
    return (0.02 * size, 0.1 * size)
