"""Takagi and Sugeno's fuzzy system from subtractive clusters, trained (seed 003, 3.2): the nonlinear output equation.

    y = sum_i w_i(z) (C_i z + d_i) / sum_i w_i(z),   w_i(z) = exp(-1/2 sum_j ((z_j - c_ij) / sigma_ij)^2)
with z the inputs scaled to the unit cube of the data. C_i and d_i are found by least squares for given centres; the training moves
centres and widths down the gradient and solves again (Jang 1993).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.envelope.output_equation.clusters import Radii, subtractive

Array = NDArray[np.float64]

EPOCHS = 20
RIDGE = 1e-6  # of the mean square regressor: rules that share few points stay finite


@dataclass(frozen=True, eq=False)
class Fuzzy:
    """Rules: centre and sigma (rules, inputs), weights (rules, inputs + 1, outputs); lowest and span (inputs,) of the scaling."""

    centre: Array
    sigma: Array
    weights: Array
    lowest: Array
    span: Array

    def __call__(self, inputs: Array) -> Array:
        """Outputs (n, outputs) of inputs (n, inputs)."""
        z = (inputs - self.lowest) / self.span
        share = _shares(z, self.centre, self.sigma)
        return np.asarray(np.einsum("ni,nio->no", share, _local(z, self.weights)))


@dataclass(frozen=True, eq=False)
class Trained:
    """The system of the smallest error, and the root mean square error, in the outputs' scale, before and after each epoch."""

    system: Fuzzy
    error: tuple[float, ...]


def fuzzy(inputs: Array, outputs: Array, scale: Array, epochs: int = EPOCHS, radii: Radii | None = None) -> Trained:
    """From inputs (n, inputs) and outputs (n, outputs) whose errors count in `scale` (outputs,).

    Clusters are sought among inputs and outputs together. The gradient's step grows by a tenth after each fall and is halved after a rise.
    """
    radii = radii or Radii()
    width = inputs.shape[1]
    found = subtractive(np.hstack([inputs, outputs]), radii)
    lowest, span = found.lowest[:width], found.span[:width]
    z, wanted = (inputs - lowest) / span, outputs / scale
    centre = z[list(found.chosen)]
    now = _solved(
        Fuzzy(centre, np.full_like(centre, radii.radius / np.sqrt(8.0)), np.empty(0), lowest, span), z, wanted
    )
    best, errors, rate = now, [_error(now, z, wanted)], 0.02
    for _ in range(epochs):
        now = _solved(_descended(best, z, wanted, rate), z, wanted)
        errors.append(_error(now, z, wanted))
        best, rate = (now, rate * 1.1) if errors[-1] < min(errors[:-1]) else (best, rate / 2)
    return Trained(replace(best, weights=np.asarray(best.weights * scale)), tuple(errors))


def _shares(z: Array, centre: Array, sigma: Array) -> Array:
    """Normalised memberships (n, rules)."""
    exponent = -0.5 * np.sum(((z[:, None] - centre) / sigma) ** 2, axis=2)
    w = np.exp(exponent - exponent.max(axis=1, keepdims=True))  # the largest is 1: no sum is 0
    return np.asarray(w / w.sum(axis=1, keepdims=True))


def _local(z: Array, weights: Array) -> Array:
    """What each rule says (n, rules, outputs)."""
    return np.asarray(np.einsum("nj,ijo->nio", np.hstack([z, np.ones((len(z), 1))]), weights))


def _solved(system: Fuzzy, z: Array, wanted: Array) -> Fuzzy:
    """The rules' weights by least squares."""
    share = _shares(z, system.centre, system.sigma)
    ones = np.hstack([z, np.ones((len(z), 1))])
    regressors = (share[:, :, None] * ones[:, None, :]).reshape(len(z), -1)
    gram = regressors.T @ regressors
    gram += RIDGE * np.trace(gram) / len(gram) * np.eye(len(gram))
    weights = np.asarray(np.linalg.solve(gram, regressors.T @ wanted), dtype=np.float64)
    return replace(system, weights=weights.reshape(share.shape[1], ones.shape[1], wanted.shape[1]))


def _estimate(system: Fuzzy, z: Array) -> tuple[Array, Array, Array]:
    share, local = _shares(z, system.centre, system.sigma), _local(z, system.weights)
    return share, local, np.einsum("ni,nio->no", share, local)


def _error(system: Fuzzy, z: Array, wanted: Array) -> float:
    return float(np.sqrt(np.mean((_estimate(system, z)[2] - wanted) ** 2)))


def gradient(system: Fuzzy, z: Array, wanted: Array) -> tuple[Array, Array]:
    """Slopes of half the mean square error by centre and by sigma, (rules, inputs) each; z scaled, weights held."""
    share, local, estimate = _estimate(system, z)
    # d y / d w_i = (y_i - y) / sum w, and d w_i brings w_i along: together share_i (y_i - y).
    pull = share * np.einsum("no,nio->ni", estimate - wanted, local - estimate[:, None]) / wanted.size
    away = (z[:, None] - system.centre) / system.sigma
    by_centre = np.einsum("ni,nij->ij", pull, away / system.sigma)
    by_sigma = np.einsum("ni,nij->ij", pull, away**2 / system.sigma)
    return by_centre, by_sigma


def _descended(system: Fuzzy, z: Array, wanted: Array, rate: float) -> Fuzzy:
    """One step of length `rate` (in the unit cube) down the gradient; widths stay above a twentieth of the data's range."""
    by_centre, by_sigma = gradient(system, z, wanted)
    length = np.sqrt(np.sum(by_centre**2) + np.sum(by_sigma**2))
    if length == 0.0:
        return system
    sigma = np.maximum(system.sigma - rate * by_sigma / length, 0.05)
    return replace(system, centre=system.centre - rate * by_centre / length, sigma=sigma)
