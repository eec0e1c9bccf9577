"""A motor that weakens as it warms up.

(1)  K -> K (1 - a (1 - exp(-(t - t_0) / T))),   t_0 where the run begins: its clock may have been running before
"""

from collections.abc import Iterator

import sympy

from sim.edits import with_drive
from sim.effect import Effect, EffectParameter, Role
from sim.model import TIME, Model
from sim.prior import COMMON, one_way


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on the drive of each rotor."""
    for place, rotor in model.places.rotors.items():
        yield Effect(
            name=f"{place}.warmup",
            depends=f"gain(t) of {rotor.variable}",
            parameters=(
                EffectParameter("a", "-", -0.5, 0.5, 0.03, 0.0, unlikely=one_way("a motor that warms up weakens")),
                EffectParameter("T", "s", 0.5, 500.0, 20.0, starts=(5.0, 20.0, 60.0)),
                EffectParameter("t_0", "s", -1.0e10, 1.0e10, 0.0, refining=True, role=Role.BEGINNING),
            ),
            equation="K -> K (1 - a (1 - exp(-(t - t_0)/T)))",
            story="The motor's winding warms up and its resistance grows, so the same command gives less and less.",
            source="copper's resistance grows by 0.39 % per kelvin",
            prior=COMMON,
            edit=lambda model, a, T, t_0, place=place: with_drive(
                model, place, 1 - a * (1 - sympy.exp(-(TIME - t_0) / T))
            ),
            twins={f"{place.replace('rotor', 'input')}.gain": "once warm, the drive is down by a constant share"},
        )
