"""Nonlinear least squares over many runs: Levenberg-Marquardt with exact slopes, a prior, bounds, and window starts projected out.

    minimise  V(theta, xi) = sum r(theta, xi)^T r(theta, xi) + |theta - mean|^2_Lambda + sum |(xi - xi_0) / sd_xi|^2

r are the residuals over their standard deviations, so V is criterion (10) of seed 000 with Q_V = diag(1 / sd^2). The windows' starts
xi are eliminated from each step (normal_equations.py).
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.levenberg_marquardt import MARQUARDT, trials
from identification.fit.normal_equations import Point, at, reduced, weak_hold
from identification.fit.problem import Problem
from identification.runs.run import Run, free_places, with_starts

Array = NDArray[np.float64]
MAX_STEPS = 60  # better points: a fit that still crawls along a valley then is left where it is
SETTLED = 1e-3  # a step below this many standard deviations, squared and summed, changes nothing
INFORMED = 2.0  # information on a direction, relative to its size: 1 is that it has a size at all

Watch = Callable[[Point], None]


def solve(problem: Problem, watch: Watch | None = None, settled: float = SETTLED) -> Point:
    """Minimise V from the problem's start until a step is `settled`; `watch` is told each better point.

    From a start whose motion leaves the range of numbers no slope leads away: it is given back.
    """
    point = at(problem, problem.start, problem.runs)
    if not np.isfinite(point.cost):
        return point

    def moved(point: Point, damping: float) -> Point | None:
        theta, runs, length = _step(problem, point, damping)
        return None if length < settled else at(problem, theta, runs)

    better = filter(None, trials(point, moved, MARQUARDT))
    for steps, found in zip(range(1, MAX_STEPS + 1), better, strict=False):
        point = replace(found, steps=steps)
        if watch is not None:
            watch(point)
    return point


def leapt(problem: Problem) -> Problem:
    """The problem from where one undamped step leads, if that is better.

    Along a direction that only the prior tells, damping by the data's slopes, which an unstable plant lets grow, stops every step short.
    """
    before = at(problem, problem.start, problem.runs)
    theta, runs, _ = _step(problem, before, 0.0)
    return replace(problem, start=theta, runs=runs) if at(problem, theta, runs).cost < before.cost else problem


def _step(problem: Problem, point: Point, damping: float) -> tuple[Array, tuple[Run, ...], float]:
    """The damped step: new parameters, runs at their new starts, and its length in standard deviations, squared."""
    prior = problem.prior
    H, g, back = reduced(point, damping)
    A = H + prior.information
    b = g + prior.information @ (prior.mean - point.theta)
    damped = A + damping * np.diag(np.diag(point.JtJ)) + weak_hold(problem)
    step = _within(problem, point.theta, damped, A, b)
    length, runs = float(step @ A @ step), []
    for run, starts, (own, follow) in zip(point.runs, point.starts, back, strict=True):
        moved = own - follow @ step
        length += float(np.einsum("wf,wfg,wg->", own, starts.C, own))
        x0 = run.x0.copy()
        x0[:, free_places(run)] += moved
        runs.append(with_starts(run, x0))
    return point.theta + step, tuple(runs), length


def _within(problem: Problem, theta: Array, damped: Array, A: Array, b: Array) -> Array:
    """The damped step within the bounds: what would leave them is held at its bound and the rest solved again."""
    held, step = np.zeros(b.size, dtype=bool), np.zeros(b.size)
    while not held.all():
        free = ~held
        own = np.ix_(free, free)
        pull = b[free] - damped[np.ix_(free, held)] @ step[held]
        step[free] = _informed_step(damped[own], A[own], pull, problem.scale[free])
        out = free & ((theta + step < problem.lower) | (theta + step > problem.upper))
        if not out.any():
            break
        step[out] = np.clip(theta + step, problem.lower, problem.upper)[out] - theta[out]
        held |= out
    return step


def _informed_step(damped: Array, A: Array, b: Array, scale: Array) -> Array:
    """damped^-1 b in the span of the directions of which A knows something, or along which there is still a lot to gain.

    Where the data know nothing of a direction the way down is a curved valley, along which a fit would crawl for nothing: it stays where
    it is. A knows a direction v of S A S with v^T S A S v > `INFORMED`; what is left to gain by it is (v^T S b)^2 over that, in variances.
    """
    information, V = np.linalg.eigh(A * np.outer(scale, scale))
    with np.errstate(over="ignore"):  # far from the rig: infinitely much is to be gained
        gain = (V.T @ (scale * b)) ** 2
    open_to_data = (information > INFORMED) | (gain > np.maximum(information, 1.0))
    if open_to_data.all():
        return np.asarray(np.linalg.solve(damped, b))
    V = scale[:, None] * V[:, open_to_data]
    return np.asarray(V @ np.linalg.solve(V.T @ damped @ V, V.T @ b))
