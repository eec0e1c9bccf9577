"""How many Runge-Kutta steps a sample gets: doubled until a further doubling no longer counts.

One step per sample follows a rate of 1/T to z^4 / 120 of itself, z = period / T: 0.1 % at z = 0.6, a tenth at z = 1.9, and it breaks down
at z = 2.8. A motor's current or a small rotor is faster than that at the usual sample rates.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.normal_equations import Point, leaned
from identification.fit.problem import Problem
from identification.runs.prediction import predicted
from identification.runs.run import Run, parameters_of
from records.errors import BadInput
from sim.substeps import LARGEST_STEP, fastest_rad_s

Array = NDArray[np.float64]
MOST_PER_SAMPLE = 64
FOLLOWED = 1e-3  # of a channel's own motion: a start's prediction this near to that with half the step is good enough to fit from
IMPOSSIBLE = 1e6  # of all motion read: no plant goes so far within a window
SHIFT_SD = 0.1  # estimates that half the step would move by less than this are good enough to keep


def halved(run: Run) -> Run:
    """The same run in twice as many steps."""
    return replace(run, substeps=2 * run.substeps)


def followed(run: Run) -> Run:
    """The run in as many steps as its windows need with the plant's parameters as they are; raises BadInput where the most break down."""
    before = predicted(run, (), np.zeros(0))
    while run.substeps < MOST_PER_SAMPLE:
        more = halved(run)
        after = predicted(more, (), np.zeros(0))
        if _near(run, before, after):
            break
        run, before = more, after
    if not np.all(np.abs(before - run.y) < IMPOSSIBLE * (np.ptp(run.y) + run.sd)):
        raise BadInput(
            "log", run.name, f"a prediction that leaves all bounds, in {MOST_PER_SAMPLE} steps per sample too",
            "a plant whose fastest part shows at this sample rate", "check its parameters, or leave that part out",
        )  # fmt: skip
    return run


def in_steps_of(run: Run, names: Sequence[str], theta: Array) -> Run:
    """The run in as many steps a sample as the fastest motion at theta takes; as it is where `MOST_PER_SAMPLE` are too few."""
    there = replace(run.bound, p=parameters_of(run, names, theta))
    needed = fastest_rad_s(there, run.x0[0]) * float(np.max(np.diff(run.t_s))) / LARGEST_STEP
    return replace(run, substeps=max(run.substeps, math.ceil(needed))) if needed <= MOST_PER_SAMPLE else run


def _near(run: Run, before: Array, after: Array) -> bool:
    if not np.all(np.isfinite(before)):
        return False
    for number in range(len(run.channels)):
        mine = run.channel == number
        motion = float(np.std(after[mine])) if mine.any() else 0.0
        if motion > 0.0 and np.sqrt(np.mean((after[mine] - before[mine]) ** 2)) > FOLLOWED * motion:
            return False
    return True


def shift_sd(problem: Problem, point: Point) -> float:
    """How far the estimates would go, in standard deviations of the farthest combination, if every step were halved.

    To first order sqrt(g' A^-1 g) with g = J' (y_h/2 - y_h) / sd, the windows' starts eliminated, and A the information.
    """
    apart = [
        (predicted(halved(run), problem.names, point.theta) - predicted(run, problem.names, point.theta)) / run.sd
        for run in point.runs
    ]
    if not all(np.all(np.isfinite(entry)) for entry in apart):
        return np.inf
    A, g = leaned(problem, point, apart)
    return float(np.sqrt(max(0.0, float(g @ np.linalg.solve(A, g))))) if g.size else 0.0


def finer(runs: Sequence[Run], point: Point) -> tuple[Run, ...]:
    """The runs in half the steps from where the point's windows start, weighed as they came."""
    return tuple(
        replace(halved(run), x0=moved.x0, first=moved.first) for run, moved in zip(runs, point.runs, strict=True)
    )
