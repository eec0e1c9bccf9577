"""The LQG's loop at one operating point, as its margins are judged."""

from typing import Protocol

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from controllers.coupled import LinearController
from design.discretise import SampledPlant
from design.loop import OpenLoop, PlantPolynomials, plant_polynomials
from records.table import Polynomial

Array = NDArray[np.float64]


class LqgPolynomials(Protocol):
    """Polynomials of (C.11) to (C.13) of controllers/lqg.py."""

    @property
    def a(self) -> tuple[Polynomial, ...]:
        """(n,)"""

    @property
    def b(self) -> tuple[Polynomial, ...]:
        """(n,)"""

    @property
    def k(self) -> tuple[Polynomial, ...]:
        """(n + 1,)"""

    @property
    def g_V_rad(self) -> Polynomial:
        """In the units of the loop."""

    @property
    def inverse_g_rad_V(self) -> Polynomial:
        """Likewise."""

    @property
    def l(self) -> tuple[Polynomial, ...]:  # noqa: E743  # the field's letter
        """(n + 1,)"""


def controller_at(gains: LqgPolynomials, schedule_rad: float) -> LinearController:
    """The law with its coefficients as float32 at schedule_rad [rad], in the state (y, x, held)."""
    a, b, k, l, g = (  # noqa: E741
        np.array([polyval(schedule_rad, np.array(row, np.float32)) for row in rows])
        for rows in (gains.a, gains.b, gains.k, gains.l, (gains.g_V_rad, gains.inverse_g_rad_V))
    )
    b, k = g[1] * b, g[0] * k
    order = len(a)
    kept = np.eye(order + 1)
    kept[:, 0] -= l  # (C.11) without the measurement
    moved = np.eye(order + 1) + np.eye(order + 1, k=1)
    moved[0, 1] = 0.0
    moved[1:, 1] -= a
    moved[0, 1:] = moved[1, 1:]
    closed = moved - np.outer(np.append(b[0], b), k)
    N = np.zeros((order + 2, order + 2))
    N[:-1, :-1] = closed @ kept - np.eye(order + 1)
    N[-1, :-1] = -k @ kept
    return LinearController(N, np.append(closed @ l, -k @ l), np.append(-k @ kept, 1.0), float(-k @ l))


def open_loop(controller: LinearController, plant: PlantPolynomials) -> OpenLoop:
    """L of the loop opened at the plant's input."""
    found = plant_polynomials(SampledPlant(controller.N, controller.B[:, np.newaxis], controller.C[np.newaxis], 1.0))
    return OpenLoop(plant.b, plant.a, -(found.b + controller.D * found.a), found.a, plant.sample_period_s)
