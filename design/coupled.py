"""Both loops closed on the whole linearised plant, with the cross-coupling that the design of each axis leaves out.

The controllers stand here in the state that the law itself keeps, so this is also a second way to the poles of one axis.
"""

import numpy as np
from numpy.typing import NDArray

from design.direct_form import DeltaForm
from design.discretise import SampledPlant
from design.loop import Poles, to_rad_s

Array = NDArray[np.float64]

ERRORS = 3  # of the error and its differences that the law remembers


def controller_states(controller: DeltaForm) -> tuple[Array, Array, Array, float]:
    """A (m, m), B (m,), C (m,), D of the unlimited law from e to v, in the state (e, its differences, s, its differences)."""
    q_0, q_1, q_2, q_3 = controller.q
    C = np.array([-(q_1 + q_2 + q_3), -(q_2 + q_3), -q_3, 1.0 - controller.p[0], *controller.p[1:]])
    D = float(q_0 + q_1 + q_2 + q_3)
    A, B = np.zeros((len(C), len(C))), np.full(len(C), D)
    for row in range(ERRORS):
        A[row, :row] = -1.0
    for row in range(ERRORS, len(C)):
        A[row] = C
        A[row, ERRORS:row] -= 1.0
    B[:ERRORS] = 1.0
    return A, B, C, D


def coupled_step(plant: SampledPlant, controllers: tuple[DeltaForm, ...]) -> Array:
    """The matrix of one sample of the closed loop minus I, over plant and controllers; controller i takes output i to input i."""
    n = len(plant.N)
    memories = [ERRORS + len(controller.p) for controller in controllers]
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
