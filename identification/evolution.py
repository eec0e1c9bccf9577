"""Differential evolution on criterion (10), by SciPy: what stands in for the commercial toolbox of seed 000."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, differential_evolution

from identification.prediction import predicted
from identification.solve import Problem

Array = NDArray[np.float64]
GENERATIONS, POPULATION = 60, 8  # the population is 8 members for each parameter
HUGE = 1e100  # of a motion that leaves all bounds; SciPy squares it


def evolution(
    problem: Problem, places: list[int], seed: int, watch: Callable[[Array], None]
) -> tuple[Array, tuple[float, ...]]:
    """The best values at `places` and the least criterion of each generation; wide positive bounds are searched by logarithms.

    `watch` is told the best values so far after each generation.
    """
    lower, upper = problem.lower[places], problem.upper[places]
    logarithmic = lower > 0.0

    def unscaled(position: Array) -> Array:
        theta = problem.start.copy()
        theta[places] = np.where(logarithmic, np.exp(position), position)
        return theta

    def cost(position: Array) -> float:
        theta = unscaled(position)
        with np.errstate(over="ignore", invalid="ignore"):
            total = sum(
                float(np.sum(((run.y - predicted(run, problem.names, theta)) / run.sd) ** 2)) for run in problem.runs
            )
        return min(total, HUGE) if np.isfinite(total) else HUGE

    bounds = [(np.log(a), np.log(b)) if log else (a, b) for a, b, log in zip(lower, upper, logarithmic, strict=True)]
    started = np.where(logarithmic, np.log(np.maximum(problem.start[places], 1e-300)), problem.start[places])
    best: list[float] = []

    def told(intermediate_result: OptimizeResult) -> None:
        best.append(float(intermediate_result.fun))
        watch(unscaled(intermediate_result.x)[places])

    wishes = {"maxiter": GENERATIONS, "popsize": POPULATION, "tol": 1e-3, "polish": False}
    found = differential_evolution(cost, bounds, seed=seed, x0=started, callback=told, **wishes)
    return unscaled(found.x)[places], tuple(best)
