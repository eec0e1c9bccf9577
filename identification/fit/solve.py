"""Nonlinear least squares over many runs: Levenberg-Marquardt with exact slopes, a prior, bounds, and window starts projected out.

    minimise  V(theta, xi) = sum r(theta, xi)^T r(theta, xi) + |theta - mean|^2_Lambda + sum |(xi - xi_0) / sd_xi|^2

r are the residuals over their standard deviations, so V is criterion (10) of seed 000 with Q_V = diag(1 / sd^2). A window's start
xi appears in its own residuals alone and is eliminated from each step's normal equations (variable projection): their size is that
of theta, however many windows there are.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.levenberg_marquardt import MARQUARDT, trials
from identification.runs.prediction import Block, blocks
from identification.runs.run import Run, state_places, with_starts

Array = NDArray[np.float64]
MAX_STEPS = 60
SETTLED = 1e-3  # a step below this many standard deviations, squared and summed, changes nothing
ROUNDING = 1e-12
INFORMED = 2.0  # information on a direction, relative to its size: 1 is that it has a size at all


Tell = Callable[[Array], None]  # parameters (parameters,)
Told = Callable[[Mapping[str, float]], None]  # the same by name


@dataclass(frozen=True, eq=False)
class Prior:
    """What is known before: mean (parameters,) and information Lambda (parameters, parameters), zero where nothing is known."""

    mean: Array
    information: Array


@dataclass(frozen=True, eq=False)
class Problem:
    """Runs and the parameters `names` to fit: start, typical size `scale`, bounds, prior; all of shape (parameters,)."""

    names: tuple[str, ...]
    start: Array
    scale: Array
    lower: Array
    upper: Array
    runs: tuple[Run, ...]
    prior: Prior


@dataclass(frozen=True, eq=False)
class Starts:
    """The normal equations of all windows' starts of one run: C (windows, free, free), B = J^T X (windows, parameters, free) and
    c (windows, free), the starts' own gradient.
    """

    C: Array
    B: Array
    c: Array


@dataclass(frozen=True, eq=False)
class Point:
    """Parameters theta with the runs at their window starts: cost V, J^T J and J^T r over all residuals, and each run's starts."""

    theta: Array
    runs: tuple[Run, ...]
    cost: float
    JtJ: Array
    Jtr: Array
    starts: tuple[Starts, ...]
    blocks: tuple[tuple[Block, ...], ...]
    steps: int = 0

    @property
    def H(self) -> Array:
        """Information of the data on theta once the starts are eliminated, (parameters, parameters); positive in spite of rounding."""
        H = _reduced(self, 0.0)[0]
        return np.asarray((H + H.T) / 2.0 + ROUNDING * np.diag(np.diag(self.JtJ)))


Watch = Callable[[Point], None]


def by_name(names: Sequence[str], told: Told | None) -> Tell:
    """Tells the parameters (parameters,) by name to the one who watches, if there is one."""

    def tell(theta: Array) -> None:
        if told is not None:
            told(dict(zip(names, theta.tolist(), strict=True)))

    return tell


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


def at(problem: Problem, theta: Array, runs: tuple[Run, ...]) -> Point:
    """Cost and normal equations at theta; a motion that leaves the range of numbers costs infinitely much."""
    size = len(problem.names)
    JtJ, Jtr = np.zeros((size, size)), np.zeros(size)
    away = theta - problem.prior.mean
    cost = float(away @ problem.prior.information @ away)
    found, starts = [], []
    with np.errstate(over="ignore", invalid="ignore"):
        for run in runs:
            own = blocks(run, problem.names, theta)
            for block in own:
                JtJ += block.by_parameter.T @ block.by_parameter
                Jtr += block.by_parameter.T @ block.residual
                cost += float(block.residual @ block.residual)
            starts.append(_starts(run, own))
            cost += float(np.sum((_off(run) / run.start_sd) ** 2)) if run.free else 0.0
            found.append(own)
    finite = np.isfinite(cost) and np.all(np.isfinite(JtJ))
    return Point(theta, runs, cost if finite else np.inf, JtJ, Jtr, tuple(starts), tuple(found))


def _starts(run: Run, own: tuple[Block, ...]) -> Starts:
    weight = 1.0 / run.start_sd**2
    C = np.stack([block.by_start.T @ block.by_start + np.diag(w) for block, w in zip(own, weight, strict=True)])
    # Starts whose slopes have grown past all digits look parallel.
    C += ROUNDING * np.einsum("wff->wf", C)[:, :, None] * np.eye(C.shape[1])
    B = np.stack([block.by_parameter.T @ block.by_start for block in own])
    c = np.stack([block.by_start.T @ block.residual for block in own]) - weight * _off(run)
    return Starts(C, B, c)


def _off(run: Run) -> Array:
    """How far the free starts have moved from the run's first guess, (windows, free)."""
    return np.asarray((run.x0 - run.guess)[:, _free_places(run)])


def _free_places(run: Run) -> list[int]:
    places = state_places(run.bound.model)
    return [places[name] for name in run.free]


def _reduced(point: Point, damping: float) -> tuple[Array, Array, tuple[tuple[Array, Array], ...]]:
    """H = J^T J - sum B C^-1 B^T and its gradient; for each run C^-1 c and C^-1 B^T, from which the starts' steps follow."""
    H, g = point.JtJ.copy(), point.Jtr.copy()
    back: list[tuple[Array, Array]] = []
    for starts in point.starts:
        C = starts.C * (1.0 + damping * np.eye(starts.C.shape[-1]))
        own: Array = np.asarray(np.linalg.solve(C, starts.c[:, :, None])[:, :, 0])
        follow: Array = np.asarray(np.linalg.solve(C, np.swapaxes(starts.B, 1, 2)))
        H -= np.einsum("wpf,wfq->pq", starts.B, follow)
        g -= np.einsum("wpf,wf->p", starts.B, own)
        back.append((own, follow))
    return H, g, tuple(back)


def alone(point: Point, number: int) -> tuple[Array, Array]:
    """What one run says at the point: its information (parameters, parameters) and gradient, its windows' starts eliminated."""
    own = point.blocks[number]
    JtJ = np.sum([block.by_parameter.T @ block.by_parameter for block in own], axis=0)
    Jtr = np.sum([block.by_parameter.T @ block.residual for block in own], axis=0)
    H, g, _ = _reduced(replace(point, JtJ=JtJ, Jtr=Jtr, starts=(point.starts[number],)), 0.0)
    return (H + H.T) / 2.0 + ROUNDING * np.diag(np.diag(JtJ)), g


def leaned(problem: Problem, point: Point, apart: Sequence[Array]) -> tuple[Array, Array]:
    """The information A (parameters, parameters) and J' d, by which readings of each run that differ by d (m,) sd would move theta.

    The windows' starts are eliminated: to first order theta moves by A^-1 J' d.
    """
    g, starts = np.zeros(len(problem.names)), []
    for d, own, known in zip(apart, point.blocks, point.starts, strict=True):
        for block in own:
            g += block.by_parameter.T @ d[block.place]
        starts.append(replace(known, c=np.stack([block.by_start.T @ d[block.place] for block in own])))
    H, reduced, _ = _reduced(replace(point, Jtr=g, starts=tuple(starts)), 0.0)
    return H + problem.prior.information + 1e-12 * np.diag(1.0 / problem.scale**2), reduced


def _step(problem: Problem, point: Point, damping: float) -> tuple[Array, tuple[Run, ...], float]:
    """The damped step: new parameters, runs at their new starts, and its length in standard deviations, squared."""
    prior = problem.prior
    H, g, back = _reduced(point, damping)
    A = H + prior.information
    b = g + prior.information @ (prior.mean - point.theta)
    damped = A + damping * np.diag(np.diag(point.JtJ)) + 1e-12 * np.diag(1.0 / problem.scale**2)
    step = _within(problem, point.theta, damped, A, b)
    length, runs = float(step @ A @ step), []
    for run, starts, (own, follow) in zip(point.runs, point.starts, back, strict=True):
        moved = own - follow @ step
        length += float(np.einsum("wf,wfg,wg->", own, starts.C, own))
        x0 = run.x0.copy()
        x0[:, _free_places(run)] += moved
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
    gain = (V.T @ (scale * b)) ** 2
    open_to_data = (information > INFORMED) | (gain > np.maximum(information, 1.0))
    if open_to_data.all():
        return np.asarray(np.linalg.solve(damped, b))
    V = scale[:, None] * V[:, open_to_data]
    return np.asarray(V @ np.linalg.solve(V.T @ damped @ V, V.T @ b))
