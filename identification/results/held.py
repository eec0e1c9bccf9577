"""What the intervals of a fit leave out: parameters that were held, though the plant file does not know them exactly."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.experiments.table import aid_unit
from identification.fit.belief import stated
from identification.fit.normal_equations import at
from identification.fit.problem import Prior, Problem
from identification.results.plant_file import numbers
from identification.runs.run import coefficient_names
from identification.stages.estimate import Estimate
from sim.bind import BoundPlant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Leaning:
    """A parameter `name`, in `unit`, that is off by `by`, more than its own sd, if those `held` are off by theirs."""

    name: str
    unit: str
    by: float
    sd: float
    held: tuple[str, ...]


def leaning(bound: BoundPlant, fit: Estimate) -> tuple[Leaning, ...]:
    """The estimates that held parameters may move by more than their stated sd, by the plant file's sd and correlation of these.

    d(estimate) / d(held) = -covariance J_f^T J_h, with the windows' starts eliminated; to first order.
    """
    known = stated(bound)
    in_runs = {name for run in fit.runs for name in coefficient_names(run.bound.model)}
    held = tuple(name for name in known.names if name in in_runs and name not in fit.belief.names)
    if not held:
        return ()
    own = len(fit.belief.names)
    moves = -fit.belief.covariance @ _information(fit, held)[:own, own:]
    spread = known.part(held)
    by = np.sqrt(np.einsum("ij,jk,ik->i", moves, spread.covariance, moves))
    each, units = np.abs(moves) * spread.sd, numbers(bound.plant)
    rows = zip(fit.belief.names, by.tolist(), fit.belief.sd.tolist(), each, strict=True)
    return tuple(
        Leaning(
            name,
            units[name][2] if name in units else aid_unit(name),
            off,
            sd,
            tuple(held[place] for place in np.argsort(-row) if row[place] > sd),
        )
        for name, off, sd, row in rows
        if off > sd
    )


def _information(fit: Estimate, held: Sequence[str]) -> Array:
    """The data's information on the estimates and those held together, at the fit."""
    names = (*fit.belief.names, *held)
    known = {
        name: float(value)
        for run in fit.runs
        for name, value in zip(coefficient_names(run.bound.model), run.bound.p, strict=True)
    }
    values = [known[name] for name in held]
    theta = np.concatenate([fit.belief.mean, values])
    nothing = Prior(theta, np.zeros((theta.size, theta.size)))
    return at(Problem(names, theta, np.ones(theta.size), theta, theta, fit.runs, nothing), theta, fit.runs).H
