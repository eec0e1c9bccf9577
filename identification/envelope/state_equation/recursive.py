"""Recursive least squares with forgetting for x(k + 1) = A x(k) + B u(k) (seed 003, 2.2), and the choice among its estimates.

The thesis writes its normal equations once as X = AB IO, (2.9), and once so that (2.17) solves X = IO AB; the latter is meant and used
here: one row of IO is io' = [x' u'], (2.5), and theta (states + inputs, states) is [A B] transposed.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.flight import Deviations
from records.errors import BadInput

Array = NDArray[np.float64]

LARGE = 1e6  # diagonal of the first P: nothing is known yet


@dataclass(frozen=True, eq=False)
class Pairs:
    """Rows io (n, states + inputs) and the states that followed them (n, states)."""

    io: Array
    after: Array


@dataclass(frozen=True, eq=False)
class Recursion:
    """theta (states + inputs, states) and P (states + inputs, states + inputs) after some rows."""

    theta: Array
    P: Array


def pairs(data: Deviations) -> Pairs:
    """One row for each step within a flight; the step across a joint is no motion and is left out."""
    io = np.concatenate([data.x[:, :-1], data.u[:, :-1]], axis=2)
    return Pairs(io.reshape(-1, io.shape[2]), data.x[:, 1:].reshape(-1, data.x.shape[2]))


def start(states: int, inputs: int, large: float = LARGE) -> Recursion:
    """Step (2) of the algorithm: P large and diagonal, theta zero."""
    return Recursion(np.zeros((states + inputs, states)), large * np.eye(states + inputs))


def step(before: Recursion, io: Array, after: Array, forgetting: float) -> Recursion:
    """Steps (3) to (5): the gain K (2.29), theta (2.31) and P (2.32) after one more row."""
    spread = before.P @ io
    K = spread / (forgetting + io @ spread)
    theta = before.theta + np.outer(K, after - io @ before.theta)
    P = (before.P - np.outer(K, spread)) / forgetting
    return Recursion(theta, (P + P.T) / 2)  # the rounding of many steps would else make P lose its symmetry


def history(rows: Pairs, forgetting: float = 1.0) -> Array:
    """theta after each row (n, states + inputs, states); raises BadInput unless 0 < forgetting <= 1."""
    if not 0.0 < forgetting <= 1.0:
        raise BadInput(
            "forgetting factor", "recursive least squares", f"{forgetting:g}", "above 0, at most 1", "take 1"
        )
    now = start(rows.after.shape[1], rows.io.shape[1] - rows.after.shape[1])
    found = np.empty((len(rows.io), *now.theta.shape))
    for k, (io, after) in enumerate(zip(rows.io, rows.after, strict=True)):
        now = step(now, io, after, forgetting)
        found[k] = now.theta
    return found


def potential(thetas: Array, rows: Pairs, radius: Array) -> Array:
    """Index of each estimate, tested on all rows, (2.33): the higher, the better.

    The exponent of (2.33) is lost in the text; it is taken from where the thesis says the index comes from, subtractive clustering:
    pot = sum over rows and states of exp(-4 (error / radius)^2), `radius` (states,) in the unit of each state.
    """
    alpha = 4.0 / radius**2
    return np.array([np.exp(-alpha * (rows.io @ theta - rows.after) ** 2).sum() for theta in thetas])


def best(thetas: Array, rows: Pairs, radius: Array) -> tuple[int, Array]:
    """Number of the estimate of highest potential, and all potentials."""
    found = potential(thetas, rows, radius)
    return int(np.argmax(found)), found
