"""Dry friction that differs by the direction.

(1)  level b_c + (difference / 2) (sgn(velocity) + e)

With e = 0 the axis rubs as much less one way as it rubs more the other; with 1 or -1 it rubs more one way, and the other as stated. An
axis whose equations have no friction has no e, as that would be dry friction of its own.
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.edits import axis_of, positive, sign_of, speed_name, with_axis
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, NOTHING_NEW, Prior, Unlikely

PRIOR = Prior(
    COMMON.log_odds, f"{COMMON.reason}; where no friction is stated, friction both ways comes first", frictionless=-1.6
)
ONE_WAY = EffectParameter(
    "e",
    "1",
    -1.0,
    1.0,
    0.0,
    refining=True,
    unlikely=Unlikely(
        NOTHING_NEW,
        "what rubs one way alone is dry friction beside a pull",
        below=-0.1,
        above=0.1,
        frictionless=True,
    ),
)


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis; the level stays at or above 0."""
    for axis, entry in model.places.axes.items():
        size, speed, has_own = entry.torque_size, speed_name(model, axis), axis_of(model, axis).coulomb != 0
        one_way = (ONE_WAY,) if has_own else ()
        direction = f"(sgn({speed}) + e)" if has_own else f"sgn({speed})"
        yield Effect(
            name=f"{axis}.friction_asymmetry",
            depends=f"torque(sgn {speed})",
            parameters=(
                EffectParameter(
                    "difference",
                    entry.torque_unit,
                    -0.5 * size,
                    0.5 * size,
                    0.005 * size,
                    0.0,
                    (-0.005 * size, 0.005 * size),
                ),
                *one_way,
            ),
            equation=f"- (b_c + difference/2 {direction}) sgn({speed})",
            story="The bearing rubs harder one way than the other.",
            source="Coulomb friction by direction",
            prior=PRIOR,
            holds_at_rest=True,
            edit=lambda model, difference, *e, axis=axis: _edit(model, difference, sum(e), axis),
            twins={
                f"{axis}.offset_force": "while the axis moves, both are one constant torque",
                f"{axis}.coulomb": "what rubs one way only is half as much both ways beside a pull",
            },
        )


def _edit(model: Model, difference: sympy.Symbol, e: sympy.Expr | int, name: str) -> Model:
    more = difference / 2 * (sign_of(model, name) + e)
    return with_axis(model, name, lambda axis: replace(axis, coulomb=positive(axis.coulomb + more)))
