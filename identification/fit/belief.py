"""What is known of a set of parameters: a mean and a joint covariance, handed from stage to stage."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.fit.information import inverse
from identification.fit.problem import Prior
from sim.bind import BoundPlant

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Belief:
    """Normal distribution over the parameters `names`: mean (n,), covariance (n, n) in SI units."""

    names: tuple[str, ...]
    mean: Array
    covariance: Array

    @property
    def sd(self) -> Array:
        """Standard deviations (n,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> Array:
        """Correlation matrix (n, n) with a diagonal of exactly 1."""
        scaled = self.covariance / np.outer(self.sd, self.sd)
        np.fill_diagonal(scaled, 1.0)
        return np.asarray(np.clip((scaled + scaled.T) / 2.0, -1.0, 1.0))

    def value(self, name: str) -> float:
        """The mean of one parameter."""
        return float(self.mean[self.names.index(name)])

    def part(self, names: Sequence[str]) -> "Belief":
        """The marginal distribution of some of the parameters."""
        places = [self.names.index(name) for name in names]
        return Belief(tuple(names), self.mean[places], self.covariance[np.ix_(places, places)])


NOTHING = Belief((), np.zeros(0), np.zeros((0, 0)))


def stated(bound: BoundPlant) -> Belief:
    """What a plant file says it knows: values, sd and correlation of all coefficients whose sd is above 0."""
    names = tuple(str(symbol) for symbol, sd in zip(bound.model.parameter_symbols, bound.sd, strict=True) if sd > 0.0)
    known = bound.sd > 0.0
    correlation = bound.plant.correlation
    spread = np.eye(len(names)) if correlation is None else correlation.spread_over(names)
    return Belief(names, bound.p[known], spread * np.outer(bound.sd[known], bound.sd[known]))


def widened(belief: Belief, names: Sequence[str], start: Mapping[str, float]) -> tuple[tuple[str, ...], Array]:
    """The belief's names with the new ones behind them, and where each starts: at its mean, or at `start`."""
    every = (*belief.names, *(name for name in names if name not in belief.names))
    means = dict(zip(belief.names, belief.mean.tolist(), strict=True))
    return every, np.array([means.get(name, start.get(name, 0.0)) for name in every])


def prior(belief: Belief, theta: Array, scale: Array) -> Prior:
    """The belief as information; a new parameter is held to its start only as firmly as its `scale`, a hundred per cent.

    That much keeps a direction of which the data know nothing in place, and moves the others by less than a hundredth of their sd.
    """
    known = belief.mean.size
    information = np.diag(np.concatenate([np.zeros(known), 1.0 / scale[known:] ** 2]))
    if known:
        information[:known, :known] = inverse(belief.covariance)
    return Prior(theta, information)
