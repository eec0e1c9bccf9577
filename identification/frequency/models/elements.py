"""The elements of an identified model's matrices with what they may be off by."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.frequency.lateral import StateSpace
from identification.frequency.models.linear_model import LinearModel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StateSpaces:
    """Matrices and the standard deviations of their elements."""

    value: StateSpace
    sd: StateSpace


def state_space_with_sd(model: LinearModel, theta: Array, covariance: Array) -> StateSpaces:
    """A, B, C, D at theta; sd of each element to first order in the parameters' covariance."""
    value = model.matrices(theta)
    assert value is not None
    sds = np.sqrt(np.diag(covariance))
    steps = [_element_slopes(model, theta, place, 1e-3 * sds[place]) for place in range(theta.size)]
    spread = {name: np.stack([getattr(step, name) for step in steps]) for name in "ABCD"}
    sd = {name: np.sqrt(np.einsum("pij,pq,qij->ij", rows, covariance, rows)) for name, rows in spread.items()}
    return StateSpaces(value, StateSpace(**sd))


def _element_slopes(model: LinearModel, theta: Array, place: int, step: float) -> StateSpace:
    """Slopes of all elements by one parameter; one-sided where the other side is outside the model's range."""
    by = np.zeros(theta.size)
    by[place] = step
    sides = [(model.matrices(theta + way * by), way) for way in (1.0, -1.0)]
    (upper, b), (lower, a) = [(of, way) for of, way in [*sides, (model.matrices(theta), 0.0)] if of is not None][:2]
    slopes = {name: (getattr(upper, name) - getattr(lower, name)) / ((b - a) * step) for name in "ABCD"}
    return StateSpace(**slopes)
