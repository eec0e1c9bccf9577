"""A draught that comes and goes, never twice alike.

(1)  torque + sigma g,  g = sqrt(2 / N) sum cos(omega_i t + phi_i),  omega_i = tan(pi/2 (i - 1/2) / N) / T,  i = 1 .. N

N sines of one size at equal shares of the spectrum 1 / (1 + omega^2 T^2): an Ornstein-Uhlenbeck process of standard deviation sigma and
correlation time T, in one draw of its phases. Another run has other phases, so no log tells them: a filter estimates g itself,

(2)  torque + g,  g' = - g / T + white noise of intensity 2 sigma^2 / T
"""

from collections.abc import Iterator
from functools import cache, partial

import sympy

from sim.edits import with_state, with_torque
from sim.effect import Effect, EffectParameter, FilterState, Role, Values
from sim.model import TIME, Model, symbol

SINES = 64
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
                EffectParameter("sigma", entry.torque_unit, 0.0, size, 0.05 * size, 0.0, role=Role.STRENGTH),
                EffectParameter("T", "s", 0.03, 30.0, 0.5, role=Role.MEMORY),
            ),
            equation=f"+ sigma g, g of {SINES} sines with the spectrum 1 / (1 + omega^2 T^2)",
            story="The air in the room is restless: it pushes the axis to and fro, never twice alike.",
            source="turbulence as an Ornstein-Uhlenbeck process, Uhlenbeck and Ornstein 1930",
            edit=lambda model, sigma, T, axis=axis: with_torque(model, axis, sigma * _draw(T)),
            repeats=False,
            filter_state=FilterState(f"{axis}_gust", partial(_unknown, axis), noise=_noise),
        )


def _draw(T: sympy.Symbol) -> sympy.Expr:
    size, sines = _numbers()
    return size * sympy.Add(*(sympy.cos(omega / T * TIME + phi) for omega, phi in sines))


@cache
def _numbers() -> tuple[sympy.Expr, tuple[tuple[sympy.Expr, sympy.Expr], ...]]:
    """sqrt(2 / N), and omega_i T and phi_i of every sine."""
    shares = [sympy.Rational(2 * i - 1, 2 * SINES) for i in range(1, SINES + 1)]
    sines = tuple((sympy.tan(sympy.pi / 2 * share).evalf(), (k * TURN).evalf()) for k, share in enumerate(shares))
    return sympy.sqrt(sympy.Rational(2, SINES)).evalf(), sines


def _unknown(axis: str, model: Model, on: sympy.Symbol, sigma: sympy.Symbol, T: sympy.Symbol) -> Model:
    """Eq (2) without its noise, which is the filter's and alone knows of sigma."""
    g = symbol(f"{axis}_gust")
    return with_torque(with_state(model, g, -g / T), axis, on * g)


def _noise(values: Values) -> tuple[float, float]:
    """Intensity of the noise on g', and the variance of g."""
    variance = values["sigma"] ** 2
    return 2.0 * variance / values["T"], variance
