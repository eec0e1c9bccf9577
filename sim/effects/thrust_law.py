"""The power law between command and thrust of rotors without a lag.

(1)  F -> F (1 + a (|u| / U - 1)),  where the model's thrust is proportional to u: a = 1 is a square law
(2)  F -> F (1 - a + a U / |u|),    where it goes with u^2: a = 1 is a straight one;  U the largest command

Beyond the bounds of a, a small command would push the other way: what falls short of a square law is a dead band's.
"""

from collections.abc import Iterator

import sympy

from sim.edits import with_thrust
from sim.effect import Effect, EffectParameter
from sim.model import Model
from sim.prior import COMMON, RARE


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) or (2), whichever the model lacks; both keep the thrust at full command."""
    for place, rotor in model.places.rotors.items():
        if rotor.drive is not None:
            continue
        law, other = ("quadratic", "linear") if rotor.linear else ("linear", "quadratic")
        yield Effect(
            name=f"{place}.{law}_thrust",
            depends=f"thrust({rotor.variable})",
            parameters=(EffectParameter("a", "-", -1.0 if rotor.linear else 0.0, 1.0, 0.2, 0.0, (0.5, 1.0)),),
            equation="F -> F (1 + a (|u|/U - 1))" if rotor.linear else "F -> F (1 - a + a U/|u|)",
            story=f"The thrust follows the command by a {law} law rather than by the {other} one of the model.",
            source="blade element theory: thrust goes with the square of the speed",
            prior=COMMON if rotor.linear else RARE,
            edit=lambda model, a, place=place: _edit(model, a, place),
        )


def _edit(model: Model, a: sympy.Symbol, place: str) -> Model:
    rotor = model.places.rotors[place]
    share = sympy.Abs(rotor.variable) / rotor.input_size
    if rotor.linear:
        return with_thrust(model, place, lambda torque: torque * (1 + a * (share - 1)))
    return with_thrust(
        model, place, lambda torque: (1 - a) * torque + a * _straight(torque, rotor.variable, rotor.input_size)
    )


def _straight(torque: sympy.Expr, u: sympy.Symbol, size: float) -> sympy.Expr:
    """c u^2 as c U |u|."""
    return torque.xreplace({u: sympy.sqrt(size * sympy.Abs(u))})
