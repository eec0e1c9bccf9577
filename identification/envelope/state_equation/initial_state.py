"""Tuning of a free run's initial state to a flight, by hand, over a grid and automatically (seed 003, 2.3.3): a "proof of match".

A free run depends linearly on its start: x(k) = x_0(k) + A^k d for a start moved by d. So the squared error in margins is a quadratic
of d, and its minimum within bounds is found exactly, instead of by the sequential quadratic programming that the thesis uses.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from identification.envelope.flights.flight import INPUTS, STATES, Deviations
from identification.envelope.state_equation.free_run import Model, free_run
from identification.margins import REQUIRED_s

Array = NDArray[np.float64]

MARGINS_MOVED = 0.25  # a start may move by so many margins from its measured value: some four sd of a good sensor
TRIM_s = 10.0  # and an error of the trim by a margin in so many seconds
GRID = 21  # places that are tried for one state


@dataclass(frozen=True, eq=False)
class Tuned:
    """The start and the drift per step that were found (8,), and the free run with them (n, 8)."""

    start: Array
    drift: Array
    x: Array


def as_measured(model: Model, flight: Deviations) -> Tuned:
    """No tuning: the first row is the start."""
    return _run(model, flight, flight.x[0, 0], np.zeros_like(flight.x[0, 0]))


def by_hand(model: Model, flight: Deviations, typed: Mapping[str, float]) -> Tuned:
    """The start as a person typed it in, whole signals by state; a state that is not among them starts as measured."""
    start = flight.x[0, 0].copy()
    for name, value in typed.items():
        place = STATES.index(name)
        start[place] = value - flight.trim[0, len(INPUTS) + place]
    return _run(model, flight, start, np.zeros_like(start))


def over_grid(model: Model, flight: Deviations, margins: Array, rounds: int = 2) -> Tuned:
    """One state after the other is moved over a grid within its reach to where the fewest points lie outside the margins.

    That is what a person does at the screen who has the patience; equal counts are told apart by the squared error.
    """
    x, start, effects = flight.x[0], flight.x[0, 0].copy(), _effects(model, flight.x.shape[1])
    base = free_run(model, flight.u, start[None])[0]
    moved = np.zeros_like(start)
    for _ in range(rounds):
        for i, margin in enumerate(margins):
            places = np.linspace(-MARGINS_MOVED * margin, MARGINS_MOVED * margin, GRID)
            others = base + effects[:, :, : len(start)] @ np.where(np.arange(len(start)) == i, 0.0, moved)
            runs = others[None] + places[:, None, None] * effects[None, :, :, i]
            moved[i] = places[_least_outside((runs - x) / margins)]
    return _run(model, flight, start + moved, np.zeros_like(start))


def automatic(model: Model, flight: Deviations, margins: Array, trim: bool = False) -> Tuned:
    """The start, and with `trim` the drift of an error of the trim too, that minimise the squared error in margins within bounds.

    The bounds are `MARGINS_MOVED` and `TRIM_s`; at the minimum the conditions of Karush, Kuhn and Tucker hold. The whole flight counts,
    unless its late errors bend the start so far that the three-second rule is broken: then half of it, a quarter, and so on.
    """
    x, needed = flight.x[0], round(REQUIRED_s / flight.sample_period_s)
    effects = _effects(model, len(x))[:, :, : (2 if trim else 1) * len(margins)]
    base = free_run(model, flight.u, flight.x[:, 0])[0]
    reach = MARGINS_MOVED * margins
    if trim:
        reach = np.concatenate([reach, margins * flight.sample_period_s / TRIM_s])
    rows = len(x)
    while True:
        # Unknowns are counted in their bounds, else the small drifts spoil the conditioning.
        matrix = (effects[:rows] * reach / margins[:, None]).reshape(-1, effects.shape[2])
        found = lsq_linear(matrix, ((x - base)[:rows] / margins).ravel(), (-1.0, 1.0), tol=1e-12)
        move = np.zeros(2 * len(margins))
        move[: len(reach)] = found.x * reach
        tuned = _run(model, flight, x[0] + move[: len(margins)], move[len(margins) :])
        rows //= 2
        if rows < needed or np.all(np.abs(tuned.x - x)[:needed] <= margins):
            return tuned


def _run(model: Model, flight: Deviations, start: Array, drift: Array) -> Tuned:
    return Tuned(start, drift, free_run(model, flight.u, start[None], drift[None])[0])


def _effects(model: Model, rows: int) -> Array:
    """What a unit of start and of drift adds to each row (rows, 8, 16)."""
    states = len(model.A)
    found = np.zeros((rows, states, 2 * states))
    found[0, :, :states] = np.eye(states)
    for k in range(rows - 1):
        found[k + 1] = model.A @ found[k]
        found[k + 1, :, states:] += np.eye(states)
    return found


def _least_outside(errors: Array) -> int:
    """Number of the run (runs, n, 8) with the fewest points outside its margins."""
    outside = np.mean(np.abs(errors) > 1.0, axis=(1, 2))
    square = np.mean(errors**2, axis=(1, 2))
    return int(np.lexsort((square, outside))[0])
