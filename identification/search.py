"""A start for the fit from anywhere within the bounds: differential evolution on criterion (10) of a part of the data.

The paper uses genetic algorithms and surrogate optimisation of a commercial toolbox for this; SciPy's differential evolution does the
same work here, on the compiled model.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution

from identification.prediction import predicted
from identification.solve import Problem

Array = NDArray[np.float64]
GENERATIONS, POPULATION = 60, 8  # the population is 8 members for each parameter
HUGE = 1e300


def search(problem: Problem, places: list[int], seed: int) -> Problem:
    """The problem with a start for the parameters at `places`, the others held; window starts stay at their guesses.

    Wide positive bounds are searched on a logarithmic scale. The same seed gives the same start.
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
        return total if np.isfinite(total) else HUGE

    bounds = [(np.log(a), np.log(b)) if log else (a, b) for a, b, log in zip(lower, upper, logarithmic, strict=True)]
    started = np.where(logarithmic, np.log(np.maximum(problem.start[places], 1e-300)), problem.start[places])
    found = differential_evolution(
        cost, bounds, maxiter=GENERATIONS, popsize=POPULATION, seed=seed, x0=started, tol=1e-3, polish=False
    )
    return replace(problem, start=unscaled(found.x))
