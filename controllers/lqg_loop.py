"""The LQG's loops at one operating point, as its margins and its coupling with the other loops are judged."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from design.analysis.coupled import POINTS
from design.analysis.margins import LOWEST_RAD_S
from design.discretise import SampledPlant
from design.loop import OpenLoop, PlantPolynomials, Poles, plant_polynomials, to_rad_s
from records.table import Polynomial

Array = NDArray[np.float64]


class Scheduled(Protocol):
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


@dataclass(frozen=True)
class LinearController:
    """x+ = (I + N) x + B y, u = C x + D y: the law of one loop without limits, at reference 0; shapes (m, m), (m,), (m,)."""

    N: Array
    B: Array
    C: Array
    D: float


def controller_at(gains: Scheduled, schedule_rad: float) -> LinearController:
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


def coupled_sensitivity(plant: SampledPlant, controllers: Sequence[LinearController]) -> Array:
    """The largest |1/(1 + L)| of each loop (loops,), opened at its input with all others closed; controller i takes output i to input i."""
    omega_rad_s = np.geomspace(LOWEST_RAD_S, math.pi / plant.sample_period_s, POINTS)
    gamma = np.expm1(1j * omega_rad_s * plant.sample_period_s)
    G = _response(gamma, plant.N, plant.B, plant.C)
    K = np.stack([_response(gamma, c.N, c.B[:, np.newaxis], c.C[np.newaxis])[:, 0, 0] + c.D for c in controllers], -1)
    S = np.linalg.inv(np.eye(len(controllers)) - K[:, :, np.newaxis] * G)
    return np.asarray(np.max(np.abs(np.diagonal(S, axis1=1, axis2=2)), axis=0))


def _response(gamma: NDArray[np.complex128], N: Array, B: Array, C: Array) -> NDArray[np.complex128]:
    """C (gamma I - N)^-1 B at each gamma: (frequencies, outputs, inputs)."""
    states = gamma[:, np.newaxis, np.newaxis] * np.eye(len(N)) - N
    return np.asarray(C @ np.linalg.solve(states, np.broadcast_to(B, (len(gamma), *B.shape))))


def coupled_poles(plant: SampledPlant, controllers: Sequence[LinearController]) -> Poles:
    """Poles s_i [rad/s] of the whole plant with all loops closed; controller i takes output i to input i."""
    count = len(plant.N)
    ends = count + np.cumsum([0, *(len(controller.N) for controller in controllers)])
    step = np.zeros((ends[-1], ends[-1]))
    step[:count, :count] = plant.N
    for index, controller in enumerate(controllers):
        own = slice(ends[index], ends[index + 1])
        step[:count, :count] += controller.D * np.outer(plant.B[:, index], plant.C[index])
        step[:count, own] = np.outer(plant.B[:, index], controller.C)
        step[own, :count] = np.outer(controller.B, plant.C[index])
        step[own, own] = controller.N
    return to_rad_s(np.linalg.eigvals(step).astype(complex), plant.sample_period_s)
