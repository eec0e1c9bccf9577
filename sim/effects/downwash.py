"""The tail rotor works in the air that the main rotor stirs.

(1)  F_T -> F_T (1 - a omega_M / 600 rad/s)
"""

from collections.abc import Iterator

import sympy

from sim.edits import with_thrust
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, one_way

FULL_SPEED = 600.0  # [rad/s]


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) where there are both rotors."""
    main, tail = model.places.lifting, model.places.turning
    if not (main and tail):
        return
    yield Effect(
        name=f"{tail}.downwash",
        depends="thrust(omega_M)",
        parameters=(EffectParameter("a", "-", -1.0, 1.0, 0.05, 0.0, unlikely=one_way("a wake takes thrust away")),),
        equation="F_T -> F_T (1 - a omega_M / (600 rad/s))",
        story="The main rotor's wake hits the tail rotor, which pushes less the faster the main rotor turns.",
        source="wake of the main rotor, to first order in its speed",
        prior=COMMON,
        edit=lambda model, a: _edit(model, a, main, tail),
        twins={
            f"{model.places.level}.quadratic_reaction": "at a constant tail speed both are a torque that grows with "
            "the main rotor's speed",
            f"{model.places.input_of(tail)}.offset": "at nearly constant speeds both are a constant torque on the azimuth",
            f"{model.places.input_of(tail)}.supply_sag": "both weaken the tail rotor when the main rotor works harder",
        },
    )


def _edit(model: Model, a: sympy.Symbol, main: str, tail: str) -> Model:
    factor = 1 - a * model.places.rotors[main].speed / FULL_SPEED
    return with_thrust(model, tail, lambda torque: torque * factor)
