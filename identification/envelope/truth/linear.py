"""The simulated helicopter's exact linear model about a trim: what the best identification of that structure could find."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from identification.envelope.flights.conditions import Condition
from identification.envelope.truth.equations import STATE_COUNT, rates
from identification.envelope.truth.figures import Machine
from identification.envelope.truth.trim import air_of, trim

Array = NDArray[np.float64]

RIGID = 8  # states of the body; the rotor's three follow at once in a quasi-steady model
STEP = 1e-5


def linearised(
    machine: Machine, condition: Condition, sample_period_s: float, climb_m_s: float = 0.0
) -> tuple[Array, Array]:
    """A (8, 8) and B (8, 4) per sample, controls held in between, by central differences about the trim.

    With x the body's states and z the rotor's: dx/dt = F x + G z + H u, 0 = M x + N z + P u, so z is eliminated; raises BadInput where
    there is no trim.
    """
    air = air_of(machine, condition)
    state, controls = trim(machine, condition, climb_m_s)

    def slope(move: Array) -> Array:
        s, c = state + move[:STATE_COUNT], controls + move[STATE_COUNT:]
        return rates(machine, air, s[:, None], c[:, None], np.zeros((3, 1)))[:, 0]

    every = STEP * np.eye(STATE_COUNT + len(controls))
    J = np.stack([(slope(move) - slope(-move)) / (2 * STEP) for move in every], axis=1)
    body, rotor, moved = slice(0, RIGID), slice(RIGID, STATE_COUNT), [*range(RIGID), *range(STATE_COUNT, len(every))]
    reduced = J[body][:, moved] - J[body, rotor] @ np.linalg.solve(J[rotor, rotor], J[rotor][:, moved])
    square = np.zeros((len(moved), len(moved)))
    square[:RIGID] = sample_period_s * reduced
    found = np.asarray(expm(square))[:RIGID]
    return found[:, :RIGID], found[:, RIGID:]
