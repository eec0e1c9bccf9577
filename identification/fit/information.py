"""Information matrices of parameters whose sizes differ by many orders: their inverse, and what is left where others are open too."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def inverse(information: Array) -> Array:
    """Inverse of a badly scaled positive definite matrix: the covariance of an information, or the other way round."""
    size = np.sqrt(np.diag(information))
    found = np.linalg.inv(information / np.outer(size, size))
    return np.asarray((found + found.T) / 2.0 / np.outer(size, size))


def marginal(information: Array, places: Sequence[int], scale: Array) -> Array:
    """Information on some parameters once the others are left to the data too: A - B D^-1 B^T."""
    others = [place for place in range(information.shape[0]) if place not in places]
    A = information[np.ix_(places, places)]
    if not others:
        return A
    B, D = information[np.ix_(places, others)], information[np.ix_(others, others)]
    floor = np.diag(1e-9 / scale[others] ** 2)
    return np.asarray(A - B @ np.linalg.solve(D + floor, B.T))
