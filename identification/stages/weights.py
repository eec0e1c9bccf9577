"""What each reading is worth, by the residuals of a fit: the size of their errors, and how long these last."""

import numpy as np

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
                sd[mine] *= max(float(np.sqrt(np.mean(residual[mine] ** 2))), 1.0 if rounded else 1e-3)
        runs.append(with_sd(run, sd))
    return tuple(runs)


def by_correlation(problem: Problem, point: Point) -> tuple[Run, ...]:
    """All sd of a channel widened by as much as its residuals' correlation asks."""
    weak = np.diag(1.0 / problem.scale**2)
    return tuple(
        with_sd(run, run.sd * np.sqrt(found)[run.channel])
        for run, found in zip(point.runs, inflations(point, weak), strict=True)
    )
