"""What the data cannot tell: combinations of parameters about which they hold too little information."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification import thresholds

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Direction:
    """A combination of parameters, each relative to its size, of which the data know nothing, or just so much: its relative sd."""

    weights: tuple[tuple[str, float], ...]
    relative_sd: float


def unseen(names: Sequence[str], H: Array, scale: Array) -> tuple[Direction, ...]:
    """Directions of the scaled information S H S whose relative sd is above `NOT_IDENTIFIED`, worst first; by its eigenvectors."""
    values, vectors = np.linalg.eigh(H * np.outer(scale, scale))
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        sd = float(1.0 / np.sqrt(max(value, 1e-24)))
        if sd > thresholds.NOT_IDENTIFIED:
            found.append(Direction(_weights(names, vector), sd))
    return tuple(found)


def _weights(names: Sequence[str], vector: Array) -> tuple[tuple[str, float], ...]:
    """The components that matter, largest first and positive."""
    order = np.argsort(-np.abs(vector))
    sign = np.sign(vector[order[0]])
    return tuple((names[place], float(sign * vector[place])) for place in order if abs(vector[place]) > 0.3)
