"""All loops closed at one operating point, each by its own controller: their poles and what margin they leave one another."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.equations.designing import Points
from controllers.equations.judging import demand_robust, demand_stable
from design.analysis.coupled import COUPLED_POINTS
from design.analysis.margins import LOWEST_RAD_S
from design.discretise import SampledPlant
from design.loop import Poles, to_rad_s

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearController:
    """x+ = (I + N) x + B y, u = C x + D y: the law of one loop without limits, at reference 0; shapes (m, m), (m,), (m,)."""

    N: Array
    B: Array
    C: Array
    D: float


def demand_held_together(
    points: Points, index: int, controllers: Mapping[str, LinearController], sensitivity: float
) -> None:
    """Raise BadInput where at this operating point the loops together are unstable, or one of them is above this max |1/(1 + L)|."""
    settings, psi_rad, whole = points.settings, float(points.psi_rad[index]), points.whole()[index]
    laws = tuple(controllers.values())
    demand_stable("slowest pole of all loops together", settings.place("all axes", psi_rad), coupled_poles(whole, laws))
    for axis, found in zip(controllers, coupled_sensitivity(whole, laws).tolist(), strict=True):
        demand_robust(settings, settings.place(axis, psi_rad), found, sensitivity)


def coupled_sensitivity(plant: SampledPlant, controllers: Sequence[LinearController]) -> Array:
    """The largest |1/(1 + L)| of each loop (loops,), opened at its input with all others closed; controller i takes output i to input i."""
    omega_rad_s = np.geomspace(LOWEST_RAD_S, math.pi / plant.sample_period_s, COUPLED_POINTS)
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
