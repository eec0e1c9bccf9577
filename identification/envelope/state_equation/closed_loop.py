"""Levenberg and Marquardt's optimisation of [A B] over free runs of growing length (seed 003, 2.3).

Besides [A B] each window has a start and a drift of its own, sixteen numbers that are eliminated from every step. The thesis tunes the
starts afterwards and knows no drift; without it an error of the trim, which a free run adds up, is taken for dynamics.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.flight import Deviations
from identification.envelope.state_equation.free_run import DIVERGED, Model, free_run, slopes, windows
from identification.fit.levenberg_marquardt import NIELSEN, trials

Array = NDArray[np.float64]

# Short windows first: a model that is stable over 2 s leads to one that is over 6 s; over the whole flight at once a poor start diverges.
LENGTHS_s = (2.0, 6.0, np.inf)
ROUNDS = 25
LEAST_FALL = 1e-4  # relative fall of the cost below which a stage ends
DRIFT_s = 20.0  # what is known of a drift beforehand: one margin in so many seconds, one sd
START = 0.1  # and of a start: so many margins beside its measured value, one sd
GOOD = 0.1  # error of a good run in margins, by which such knowledge weighs against the run


@dataclass(frozen=True, eq=False)
class Own:
    """Start and drift of each window (windows, 8)."""

    start: Array
    drift: Array


@dataclass(frozen=True, eq=False)
class Training:
    """The optimised model, what belongs to the last windows alone, and the mean square error after each round, in margins."""

    model: Model
    own: Own
    cost: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class _Task:
    """Windows to follow, u (windows, n, 4) and x (windows, n, 8), the margins (8,), and the weights of start and drift (16,)."""

    u: Array
    x: Array
    margins: Array
    known: Array


def _task(u: Array, x: Array, margins: Array, period_s: float) -> _Task:
    sd = np.concatenate([START * margins, margins * period_s / DRIFT_s])
    return _Task(u, x, margins, (GOOD / sd) ** 2)


@dataclass(frozen=True, eq=False)
class _Normal:
    """J'J and J'e: over [A B]; over each window's own sixteen; and across."""

    H: Array
    g: Array
    own_H: Array
    own_g: Array
    cross: Array


@dataclass(frozen=True, eq=False)
class _Point:
    """A model with its windows' own numbers, and the cost there."""

    task: _Task
    model: Model
    own: Own
    cost: float

    @cached_property
    def normal(self) -> _Normal:
        """The normal equations there, made when a step is asked for."""
        return _normal(self.model, self.own, self.task)


def optimise(model: Model, data: Deviations, margins: Array) -> Training:
    """Minimise the squared error of free runs, each state in units of its margin (8,).

    A start is held near its measured value by `START`, a drift near zero by `DRIFT_s`.
    """
    costs: list[float] = []
    own = Own(data.x[:, 0], np.zeros_like(data.x[:, 0]))
    for length_s in LENGTHS_s:
        rows = min(data.x.shape[1], round(min(length_s, 1e6) / data.sample_period_s))
        task = _task(*windows(data, rows), margins, data.sample_period_s)
        model, own, fallen = _stage(model, task)
        costs += fallen
    return Training(model, own, tuple(costs))


def _stage(model: Model, task: _Task) -> tuple[Model, Own, list[float]]:
    """One length of windows."""
    point = _point(model, Own(task.x[:, 0].copy(), np.zeros_like(task.x[:, 0])), task)
    costs = [point.cost]
    for better in islice(trials(point, _stepped, NIELSEN), ROUNDS):
        if better is None:
            continue
        point = better
        costs.append(point.cost)
        if costs[-2] - costs[-1] < LEAST_FALL * costs[-2]:
            break
    return point.model, point.own, costs


def _point(model: Model, own: Own, task: _Task) -> _Point:
    return _Point(task, model, own, _cost(model, own, task))


def _stepped(point: _Point, damping: float) -> _Point:
    return _point(*_moved(point.model, point.own, _solved(point.normal, damping)), point.task)


def _cost(model: Model, own: Own, task: _Task) -> float:
    """Mean square over samples and states, the windows' own knowledge among it."""
    with np.errstate(over="ignore", invalid="ignore"):
        error = (free_run(model, task.u, own.start, own.drift) - task.x) / task.margins
    error = np.nan_to_num(np.clip(error, -DIVERGED, DIVERGED), nan=DIVERGED)
    return float((np.sum(error**2) + np.sum(task.known * _away(own, task) ** 2)) / error.size)


def _away(own: Own, task: _Task) -> Array:
    """Start and drift beside what is known of them (windows, 16)."""
    return np.concatenate([own.start - task.x[:, 0], own.drift], axis=1)


def _normal(model: Model, own: Own, task: _Task) -> _Normal:
    run = free_run(model, task.u, own.start, own.drift)
    error = ((run - task.x) / task.margins).reshape(len(run), -1)
    by_model, by_own = slopes(model, task.u, run)
    J = (by_model / task.margins[:, None]).reshape(*error.shape, -1)
    S = (by_own / task.margins[:, None]).reshape(error.shape[1], -1)
    whole = J.reshape(-1, J.shape[2])
    return _Normal(
        whole.T @ whole, whole.T @ error.ravel(), S.T @ S + np.diag(task.known), error @ S + task.known * _away(own, task),
        np.einsum("wij,ik->wjk", J, S, optimize=True),
    )  # fmt: skip


def _solved(normal: _Normal, damping: float) -> tuple[Array, Array]:
    """Marquardt's step: what is the windows' own is eliminated, which leaves one system of the size of [A B]."""
    inverse = np.linalg.inv(normal.own_H + damping * np.diag(np.diag(normal.own_H)))
    carried = normal.cross @ inverse
    reduced = normal.H + damping * np.diag(np.diag(normal.H)) - np.einsum("wik,wlk->il", carried, normal.cross)
    move = -np.linalg.lstsq(reduced, normal.g - np.einsum("wik,wk->i", carried, normal.own_g), rcond=1e-14)[0]
    own = -(normal.own_g + np.einsum("wji,j->wi", normal.cross, move)) @ inverse
    return move, own


def _moved(model: Model, own: Own, step: tuple[Array, Array]) -> tuple[Model, Own]:
    states = len(model.A)
    move = step[0].reshape(states, -1)
    moved = Model(model.A + move[:, :states], model.B + move[:, states:], model.sample_period_s)
    return moved, Own(own.start + step[1][:, :states], own.drift + step[1][:, states:])
