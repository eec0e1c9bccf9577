"""The model run on the pilot's controls alone, and its optimisation so that this run follows the flight (seed 003, 2.3).

The thesis trains [A B] as the weights of a one-layer linear network whose output is fed back, by Levenberg and Marquardt's algorithm on
(2.38). Its derivatives come by back-propagation there, here by the equivalent forward recursion
    d x(k + 1) = A d x(k) + dA x(k) + dB u(k).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.flight import Deviations

Array = NDArray[np.float64]

DIVERGED = 1e6  # of the margins: a run so far off says nothing more


@dataclass(frozen=True, eq=False)
class Model:
    """A (8, 8) and B (8, 4) per sample period, for deviations from trim."""

    A: Array
    B: Array
    sample_period_s: float

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of the eigenvalues of A: above 1 a free run diverges in the end, as an unstable machine does."""
        return float(np.abs(np.linalg.eigvals(self.A)).max())


def model_of(theta: Array, sample_period_s: float) -> Model:
    """The model of a recursive estimate (12, 8)."""
    states = theta.shape[1]
    return Model(theta[:states].T.copy(), theta[states:].T.copy(), sample_period_s)


def one_step(model: Model, data: Deviations) -> Array:
    """Open loop (Fig. 2.1): each state predicted from the measured one before it (flights, n, 8); the first row is measured."""
    ahead = data.x[:, :-1] @ model.A.T + data.u[:, :-1] @ model.B.T
    return np.concatenate([data.x[:, :1], ahead], axis=1)


def free_run(model: Model, u: Array, x_start: Array, drift: Array | None = None) -> Array:
    """Closed loop (Fig. 2.10): x (runs, n, 8) from `x_start` (runs, 8) and u (runs, n, 4) alone.

    `drift` (runs, 8) is added in each step: what an error of the trim leaves, A x + B u of the true trim's distance.
    """
    x = np.empty((u.shape[0], u.shape[1], x_start.shape[1]))
    x[:, 0] = x_start
    driven = u @ model.B.T
    if drift is not None:
        driven = driven + drift[:, None, :]
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(u.shape[1] - 1):
            x[:, k + 1] = x[:, k] @ model.A.T + driven[:, k]
    return x


def slopes(model: Model, u: Array, x: Array) -> tuple[Array, Array]:
    """Derivatives of a free run x: by [A B], row by row (runs, n, 8, 96), and by its start and its drift (n, 8, 16)."""
    runs, rows, states = x.shape
    io = np.concatenate([x, u], axis=2)
    width = io.shape[2]
    found = np.zeros((runs, rows, states, states, width))
    own = np.zeros((rows, states, 2 * states))
    own[0, :, :states] = np.eye(states)
    every = np.arange(states)
    for k in range(rows - 1):
        found[:, k + 1] = (model.A @ found[:, k].reshape(runs, states, -1)).reshape(runs, states, states, width)
        found[:, k + 1, every, every] += io[:, k, None, :]
        own[k + 1] = model.A @ own[k]
        own[k + 1, :, states:] += np.eye(states)
    return found.reshape(runs, rows, states, states * width), own


def windows(data: Deviations, rows: int) -> tuple[Array, Array]:
    """u and x of all flights cut into whole windows of so many rows, (windows, rows, 4) and (windows, rows, 8)."""
    count = data.x.shape[1] // rows
    shape = (data.x.shape[0] * count, rows)
    return (
        data.u[:, : count * rows].reshape(*shape, data.u.shape[2]),
        data.x[:, : count * rows].reshape(*shape, data.x.shape[2]),
    )
