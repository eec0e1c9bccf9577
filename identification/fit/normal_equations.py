"""The normal equations of all runs at one point, with the starts of their windows eliminated.

A window's start xi appears in its own residuals alone, so that elimination (Schur's complement; variable projection, Golub and Pereyra,
SIAM J. Numer. Anal. 10, 1973) leaves a system of the size of theta, however many windows there are:

(1)  H = J^T J - sum B C^-1 B^T,   g = J^T r - sum B C^-1 c,   B = J^T X, C = X^T X + diag(1 / sd_xi^2), c = X^T r - (xi - xi_0) / sd_xi^2

with J and X the predictions' slopes by theta and by the starts, over the readings' sd, and the sums over all windows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.problem import Problem
from identification.runs.prediction import Block, blocks
from identification.runs.run import Run, free_places

Array = NDArray[np.float64]
ROUNDING = 1e-12  # of a diagonal: some thousand times what a sum of squares in float64 is rounded by


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
        H = reduced(self, 0.0)[0]
        return np.asarray((H + H.T) / 2.0 + ROUNDING * np.diag(np.diag(self.JtJ)))


def growth(point: Point) -> float:
    """How far the slopes by a window's start grow within it, times their first: exp(lambda t) of an unstable plant, at most.

    A slope's square and its rounding go into (1): beyond 1 / sqrt(`ROUNDING`) what is left of H is rounding.
    """
    most = 1.0
    for run, own in zip(point.runs, point.blocks, strict=True):
        for block in own:
            first = np.max(np.abs(block.by_start[: run.outputs]), initial=0.0)
            most = max(most, np.max(np.abs(block.by_start), initial=0.0) / first if first > 0.0 else 1.0)
    return float(most)


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
    return np.asarray((run.x0 - run.guess)[:, free_places(run)])


def reduced(point: Point, damping: float) -> tuple[Array, Array, tuple[tuple[Array, Array], ...]]:
    """H and g of (1); for each run C^-1 c and C^-1 B^T, from which the starts' steps follow. C is damped as (1 + damping) diag(C)."""
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
    H, g, _ = reduced(replace(point, JtJ=JtJ, Jtr=Jtr, starts=(point.starts[number],)), 0.0)
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
    H, moved, _ = reduced(replace(point, Jtr=g, starts=tuple(starts)), 0.0)
    return H + problem.prior.information + weak_hold(problem), moved


def weak_hold(problem: Problem) -> Array:
    """What keeps a direction without any information in place, far below all that data tell: `ROUNDING` of one over each size squared."""
    return ROUNDING * np.diag(1.0 / problem.scale**2)
