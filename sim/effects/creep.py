"""Dry friction that needs speed to build up: what stands for a grease that creeps, and for a simulation that rounds the jump at rest.

(1)  level b_c (1 - 2 s e / (1 + e)) with e = exp(-2 |v| / v_c), which is b_c tanh(|v| / v_c) with s = 1; s = 0 where v_c = 0

b_c is all dry friction of the axis, its own and what effects add. A hundredth of it is left at rest, s = 0.99: an axis without any there
would count as one without friction.
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from sim.edits import NEGLIGIBLE, axis_of, speed_name, with_axis
from sim.effect import Effect, EffectParameter
from sim.model import Model

GIVEN_WAY = 0.99  # of the level, at rest


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis that has friction as stated."""
    for axis, entry in model.places.axes.items():
        if axis_of(model, axis).coulomb == 0:
            continue
        usual, speed = entry.speed_size, speed_name(model, axis)
        yield Effect(
            name=f"{axis}.creep",
            depends=f"torque({speed})",
            parameters=(EffectParameter("v_c", f"{entry.length_unit} s^-1", 0.0, 0.05 * usual, 0.005 * usual, 0.0),),
            equation=f"- b_c tanh({speed}/v_c)",
            story="A pushed axis does not stick: it creeps, the faster the harder it is pushed, until it slides.",
            source="Coulomb friction with its jump at rest rounded off",
            edit=lambda model, v_c, axis=axis: _edit(model, v_c, axis),
            names_a_gap=False,
        )


def _edit(model: Model, v_c: sympy.Symbol, name: str) -> Model:
    present = GIVEN_WAY * v_c / (v_c + NEGLIGIBLE)
    e = sympy.exp(-2 * sympy.Abs(axis_of(model, name).velocity) / (v_c + NEGLIGIBLE))
    share = 1 - 2 * present * e / (1 + e)
    return with_axis(model, name, lambda axis: replace(axis, coulomb=axis.coulomb * share))
