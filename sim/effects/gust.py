"""A draught that comes and goes, never twice alike.

(1)  torque + sigma g,  g = sqrt(2 / N) sum cos(omega_i t + phi_i),  omega_i = tan(pi/2 (i - 1/2) / N) / T,  i = 1 .. N

N sines of one size at equal shares of the spectrum 1 / (1 + omega^2 T^2): an Ornstein-Uhlenbeck process of standard deviation sigma and
correlation time T, in one draw of its phases. Another run has other phases, so no log tells them.
"""

from collections.abc import Iterator

import sympy

from sim.edits import with_torque
from sim.effect import Effect, EffectParameter
from sim.model import TIME, Model

SINES = 16
TURN = (
    sympy.sqrt(5) - 1
) * sympy.pi  # the golden section of a turn: phases that are spread evenly whatever their number


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis."""
    for axis, entry in model.places.axes.items():
        size = entry.torque_size
        yield Effect(
            name=f"{axis}.gust",
            depends="torque(t)",
            parameters=(
                EffectParameter("sigma", entry.torque_unit, 0.0, size, 0.05 * size, 0.0),
                EffectParameter("T", "s", 0.1, 30.0, 0.5),
            ),
            equation=f"+ sigma g, g of {SINES} sines with the spectrum 1 / (1 + omega^2 T^2)",
            story="The air in the room is restless: it pushes the axis to and fro, never twice alike.",
            source="turbulence as an Ornstein-Uhlenbeck process, Uhlenbeck and Ornstein 1930",
            edit=lambda model, sigma, T, axis=axis: with_torque(model, axis, sigma * _draw(T)),
            repeats=False,
        )


def _draw(T: sympy.Symbol) -> sympy.Expr:
    shares = [sympy.Rational(2 * i - 1, 2 * SINES) for i in range(1, SINES + 1)]
    sines = [
        sympy.cos(sympy.tan(sympy.pi / 2 * share).evalf() / T * TIME + (k * TURN).evalf())
        for k, share in enumerate(shares)
    ]
    return sympy.sqrt(sympy.Rational(2, SINES)).evalf() * sympy.Add(*sines)
