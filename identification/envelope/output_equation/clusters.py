"""Subtractive clustering: centres among the data points by their potential (seed 003, 3.2.1; Chiu, J. Intell. Fuzzy Syst. 2, 1994)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Radii:
    """Neighbourhood of a centre in units of the data's range, how much wider a chosen one subdues, and the limits of potential.

    A point is taken above `accept` times the first potential and refused below `reject`; between, it must be far from the others.
    """

    radius: float = 0.3
    squash: float = 1.25
    accept: float = 0.5
    reject: float = 0.15


@dataclass(frozen=True, eq=False)
class Clusters:
    """Numbers of the points chosen, in order, their potentials then; lowest value and range (columns,) by which points are scaled."""

    chosen: tuple[int, ...]
    potentials: tuple[float, ...]
    lowest: Array
    span: Array

    def scaled(self, points: Array) -> Array:
        """Points (n, columns) in the unit cube of the data."""
        return np.asarray((points - self.lowest) / self.span)


def subtractive(points: Array, radii: Radii | None = None) -> Clusters:
    """Choose the centres among `points` (n, columns).

    P_i = sum_j exp(-4 |z_i - z_j|^2 / r_a^2); after each choice c: P_i -= P_c exp(-4 |z_i - z_c|^2 / r_b^2), r_b = squash r_a.
    The standard deviation of a cluster in a column is r_a span / sqrt(8), so that the membership equals the potential's kernel.
    """
    radii = radii or Radii()
    lowest, span = points.min(axis=0), np.ptp(points, axis=0)
    span = np.where(span > 0.0, span, 1.0)
    z = (points - lowest) / span
    square = cdist(z, z, "sqeuclidean")
    potential = np.exp(-4.0 / radii.radius**2 * square).sum(axis=1)
    first = float(potential.max())
    chosen: list[int] = []
    heights: list[float] = []
    while True:
        best = int(np.argmax(potential))
        height = float(potential[best])
        if not _accepted(height / first, square[best, chosen], radii):
            if height <= radii.reject * first:
                break
            potential[best] = 0.0  # too near to a centre: the next best is asked
            continue
        chosen.append(best)
        heights.append(height)
        potential = potential - height * np.exp(-4.0 / (radii.squash * radii.radius) ** 2 * square[best])
    return Clusters(tuple(chosen), tuple(heights), lowest, span)


def _accepted(ratio: float, square_distances: Array, radii: Radii) -> bool:
    """Chiu's rule; `square_distances` to the centres so far."""
    if ratio > radii.accept:
        return True
    if ratio <= radii.reject:
        return False
    return bool(np.sqrt(square_distances.min()) / radii.radius + ratio >= 1.0)
