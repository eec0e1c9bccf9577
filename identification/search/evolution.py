"""Differential evolution on criterion (10), by SciPy: what stands in for the commercial toolbox of seed 000."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, differential_evolution

from identification.fit.problem import Problem
from identification.runs.prediction import predicted

Array = NDArray[np.float64]
GENERATIONS, POPULATION = 60, 8  # the population is 8 members for each parameter
LEAST_SPREAD = 1e-3  # spread of the population's criteria, relative to their mean
HUGE = 1e100  # of a motion that leaves all bounds; SciPy squares it


def evolution(
    problem: Problem,
    places: list[int],
    seed: int,
    watch: Callable[[Array], None],
    progress: Callable[[int, int], None],
) -> tuple[Array, tuple[float, ...]]:
    """The best values at `places` and the least criterion of each generation; wide positive bounds are searched by logarithms.

    `watch` is told the best values so far after each generation, and `progress` which one that was, and of how many at most.
    """
    lower, upper = problem.lower[places], problem.upper[places]
    logarithmic = lower > 0.0

    def unscaled(position: Array) -> Array:
        theta = problem.start.copy()
        theta[places] = np.where(logarithmic, np.exp(position), position)
        return theta

    def cost(position: Array) -> float:
        return _criterion(problem, unscaled(position))

    bounds = [(np.log(a), np.log(b)) if log else (a, b) for a, b, log in zip(lower, upper, logarithmic, strict=True)]
    started = np.where(logarithmic, np.log(np.maximum(problem.start[places], 1e-300)), problem.start[places])
    best: list[float] = []

    def told(intermediate_result: OptimizeResult) -> None:
        best.append(float(intermediate_result.fun))
        watch(unscaled(intermediate_result.x)[places])
        progress(len(best), GENERATIONS)

    found = differential_evolution(
        cost,
        bounds,
        seed=seed,
        x0=started,
        callback=told,
        maxiter=GENERATIONS,
        popsize=POPULATION,
        tol=LEAST_SPREAD,
        polish=False,
    )
    return unscaled(found.x)[places], tuple(best)


def _criterion(problem: Problem, theta: Array) -> float:
    """Criterion (10), `HUGE` where the motion leaves all bounds."""
    with np.errstate(over="ignore", invalid="ignore"):
        residuals = [(run.y - predicted(run, problem.names, theta)) / run.sd for run in problem.runs]
        total = sum(float(np.sum(residual**2)) for residual in residuals)
    return min(total, HUGE) if np.isfinite(total) else HUGE
