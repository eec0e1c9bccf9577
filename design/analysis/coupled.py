"""All loops closed on the whole linearised plant, with the cross-coupling that the design of each axis leaves out.

The controllers stand here in the state that the law itself keeps, so this is also a second way to the poles of one axis.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.analysis.margins import LOWEST_RAD_S
from design.direct_form import DeltaForm
from design.discretise import SampledPlant
from design.loop import Poles, controller_polynomials, to_rad_s

Array = NDArray[np.float64]

COUPLED_POINTS = (
    400  # fewer than for the margins of one loop: here only the size of a peak is told, not where it crosses
)


def controller_states(controller: DeltaForm) -> tuple[Array, Array, Array, float]:
    """A (m, m), B (m,), C (m,), D of the unlimited law from e to v, in the state (e, its differences, s, its differences)."""
    errors = len(controller.q) - 1
    later = np.cumsum(controller.q[::-1])[::-1]  # q_i + q_i+1 + ..
    C = np.array([*-later[1:], 1.0 - controller.p[0], *controller.p[1:]])
    D = float(later[0])
    A, B = np.zeros((len(C), len(C))), np.full(len(C), D)
    for row in range(errors):
        A[row, :row] = -1.0
    for row in range(errors, len(C)):
        A[row] = C
        A[row, errors:row] -= 1.0
    B[:errors] = 1.0
    return A, B, C, D


def coupled_step(plant: SampledPlant, controllers: tuple[DeltaForm, ...]) -> Array:
    """The matrix of one sample of the closed loop minus I, over plant and controllers; controller i takes output i to input i."""
    n = len(plant.N)
    memories = [len(controller.q) - 1 + len(controller.p) for controller in controllers]
    step = np.zeros((n + sum(memories),) * 2)
    step[:n, :n] = plant.N
    for index, controller in enumerate(controllers):
        A, B, C, D = controller_states(controller)
        rows = slice(n + sum(memories[:index]), n + sum(memories[: index + 1]))
        output, drive = plant.C[index], plant.B[:, index]
        step[:n, :n] -= np.outer(drive, D * output)
        step[:n, rows] = np.outer(drive, C)
        step[rows, :n] = -np.outer(B, output)
        step[rows, rows] = A - np.eye(len(C))
    return step


def coupled_poles(plant: SampledPlant, controllers: tuple[DeltaForm, ...]) -> Poles:
    """Poles s_i [rad/s] of the closed loop; those that only shift memory lie at z = 0 and come out as very fast."""
    gamma = np.linalg.eigvals(coupled_step(plant, controllers)).astype(complex)
    return to_rad_s(gamma, plant.sample_period_s)


@dataclass(frozen=True)
class Coupling:
    """What the loops do to one another at one angle.

    `relative_gain` (loops,): the diagonal of Bristol's array at each loop's own crossover, real part: 1 where the other loops do not
    matter, below a half where most of what an input does to its angle comes by way of the others. `sensitivity` (loops,): the largest
    |1/(1 + L)| of each loop with all others closed.
    """

    relative_gain: tuple[float, ...]
    sensitivity: tuple[float, ...]


def coupling(plant: SampledPlant, controllers: tuple[DeltaForm, ...]) -> Coupling:
    """The coupling of stable loops over COUPLED_POINTS frequencies up to the Nyquist frequency."""
    omega_rad_s = np.geomspace(LOWEST_RAD_S, math.pi / plant.sample_period_s, COUPLED_POINTS)
    gamma = np.expm1(1j * omega_rad_s * plant.sample_period_s)[:, np.newaxis, np.newaxis]
    G = plant.C @ np.linalg.solve(
        gamma * np.eye(len(plant.N)) - plant.N, np.broadcast_to(plant.B, (COUPLED_POINTS, *plant.B.shape))
    )
    K = np.stack([_response(controller, gamma[:, 0, 0]) for controller in controllers], axis=-1)
    S = np.linalg.inv(np.eye(len(controllers)) + G * K[:, np.newaxis, :])
    gains = (G * np.linalg.inv(G).swapaxes(-1, -2)).real
    loops = range(len(controllers))
    return Coupling(
        relative_gain=tuple(float(gains[_crossover(np.abs(G[:, i, i] * K[:, i])), i, i]) for i in loops),
        sensitivity=tuple(float(np.max(np.abs(S[:, i, i]))) for i in loops),
    )


def _response(controller: DeltaForm, gamma: NDArray[np.complex128]) -> NDArray[np.complex128]:
    q, p = controller_polynomials(controller)
    return np.asarray(np.polyval(q[::-1], gamma) / np.polyval(p[::-1], gamma))


def _crossover(size: Array) -> int:
    """The place of the highest frequency with |L| of 1 or more; the first where there is none."""
    above = np.flatnonzero(size >= 1.0)
    return int(above[-1]) if above.size else 0
