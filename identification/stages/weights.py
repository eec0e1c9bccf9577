"""What each reading is worth, by the residuals of a fit: the size of their errors, and how long these last."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import norm

from identification.fit.normal_equations import Point
from identification.fit.problem import Problem
from identification.runs.run import Run, with_sd
from identification.uncertainty.correlation import inflations


def by_channel(_: Problem, point: Point) -> tuple[Run, ...]:
    """Each channel's sd set to the rms of its residuals; that of rounded readings only upwards, as their least is known."""
    runs = []
    for run, blocks in zip(point.runs, point.blocks, strict=True):
        sd, residual = run.sd.copy(), np.concatenate([block.residual for block in blocks])
        for number in range(len(run.channels)):
            mine = run.channel == number
            if mine.sum() > 1:
                rounded = run.step.size > 0 and run.step[number] > 0.0
                sd[mine] *= max(_rms(residual[mine]), 1.0 if rounded else 1e-3)
        runs.append(with_sd(run, sd))
    return tuple(runs)


def _rms(residual: NDArray[np.float64]) -> float:
    """The rms, also of residuals whose squares leave the range of numbers; 1, which changes no weight, where one of them has left it."""
    rms = float(norm(residual, check_finite=False)) / np.sqrt(residual.size)
    return rms if np.isfinite(rms) else 1.0


def by_correlation(problem: Problem, point: Point) -> tuple[Run, ...]:
    """All sd of a channel widened by as much as its residuals' correlation asks."""
    weak = np.diag(1.0 / problem.scale**2)
    return tuple(
        with_sd(run, run.sd * np.sqrt(found)[run.channel])
        for run, found in zip(point.runs, inflations(point, weak), strict=True)
    )
