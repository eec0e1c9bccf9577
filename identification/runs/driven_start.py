"""How a log's driven states began, which no window's start can tell: waited for until it no longer shows, or estimated.

Where rows are missing they are estimated with the start of each window, as far as the commands that nobody knows may have moved them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from identification.model.driven import driven_model
from identification.model.subsystem import subsystem
from identification.runs.rows import behind_missing_rows
from identification.runs.run import Carried
from records.log import RunLog
from sim.bind import BoundPlant
from sim.model import Model
from sim.runs.sensitivities import sensitivities, whole

Array = NDArray[np.float64]
FORGOTTEN = 2e-4  # of a driven state's reach: ten times that, as thrust, is as much as good bearings' friction, and moved J_E by 8 sd
MOST_WAITED = 0.25  # of a log, until how its driven states began no longer shows; in a shorter one that is estimated


@dataclass(frozen=True, eq=False)
class DrivenStart:
    """States that only the inputs drive: where they run on from, how long until that is known, or which are free and by how much.

    sd (n, free) is how far off they may be at each row.
    """

    carried: Carried | None
    known_after_s: float
    free: tuple[str, ...]
    sd: Array


def driven_start(bound: BoundPlant, log: RunLog, at_first: ArrayLike | None) -> DrivenStart:
    """From `at_first` (states,) where it is given, else from rest, or where they are read from the first reading, once that no longer
    shows, else free in each window; free as well behind missing rows.

    Free ones are guessed where the first row's inputs would have brought them; without driven states there is nothing to know.
    """
    model, part, known = bound.model, driven_model(bound.model), np.zeros((log.t_s.size, 0))
    if part is None:
        return DrivenStart(None, 0.0, (), known)
    own = subsystem(bound, part)
    if at_first is not None:
        x0 = np.asarray(at_first, dtype=float)[[model.states.index(state) for state in part.states]]
        return DrivenStart(Carried(own, x0), 0.0, (), known)
    u = np.ascontiguousarray(log.u[:, [model.inputs.index(variable) for variable in part.inputs]])
    rest = _first_read(bound, log, part)
    forgotten_s = _forgotten_s(own, log.t_s, u, rest)
    names = tuple(map(str, part.states))
    if forgotten_s <= MOST_WAITED * (log.t_s[-1] - log.t_s[0]):
        missing = behind_missing_rows(log)
        if not missing.size:
            return DrivenStart(Carried(own, rest), forgotten_s, (), known)
        left = _left_of_missing_rows(own, log.t_s, u, rest, missing)
        return DrivenStart(Carried(own, rest), forgotten_s, names, left)
    held = _run_on(own, log.t_s, np.tile(u[0], (log.t_s.size, 1)), rest)[-1]
    return DrivenStart(Carried(own, held), 0.0, names, _left_of_others(own, log.t_s, u, held, rest))


def _first_read(bound: BoundPlant, log: RunLog, part: Model) -> Array:
    """The driven states at their first reading, 0 where they have none: from an empty tank no slope may lead."""
    x0 = np.zeros(len(part.states))
    for state, y in zip(bound.model.outputs.values(), log.y.T, strict=True):
        read = y[np.isfinite(y)]
        if state in part.states and read.size:
            x0[part.states.index(state)] = read[0]
    return x0


def _forgotten_s(driven: BoundPlant, t_s: Array, u: Array, x0: Array) -> float:
    """How long after the first row it still shows with what states the log began: two runs from far starts are compared."""
    still = _run_on(driven, t_s, u, x0)
    reach = np.max(np.abs(still), axis=0)
    apart = np.flatnonzero(np.any(np.abs(_run_on(driven, t_s, u, x0 + reach) - still) > FORGOTTEN * reach, axis=1))
    return float(t_s[apart[-1]] - t_s[0]) if apart.size else 0.0


def _left_of_others(driven: BoundPlant, t_s: Array, u: Array, x0: Array, rest: Array) -> Array:
    """What is left, row by row (n, driven), of a start as far from x0 (driven,) as any inputs could have brought it."""
    largest = np.tile(_largest_inputs(driven), (t_s.size, 1))
    reach = np.max(np.abs(_run_on(driven, t_s, largest, rest)), axis=0)
    left = np.abs(_run_on(driven, t_s, u, x0 + reach) - _run_on(driven, t_s, u, x0))
    return np.asarray(np.maximum(left, FORGOTTEN * reach))


def _left_of_missing_rows(driven: BoundPlant, t_s: Array, u: Array, x0: Array, behind: NDArray[np.int64]) -> Array:
    """What is left, row by row (n, driven), of commands in missing rows that were off by as much as an input usually moves in a row."""
    steps = np.diff(t_s)[behind - 1] / np.median(np.diff(t_s))
    usual = np.sqrt(np.mean(np.diff(u, axis=0) ** 2, axis=0))
    other = u.copy()
    other[behind - 1] += usual * (1.0 - 1.0 / steps)[:, None]
    still = _run_on(driven, t_s, u, x0)
    left = np.abs(_run_on(driven, t_s, other, x0) - still)
    return np.asarray(np.maximum(left, FORGOTTEN * np.max(np.abs(still), axis=0)))


def _run_on(driven: BoundPlant, t_s: Array, u: Array, x0: Array) -> Array:
    return sensitivities(driven.model, whole(t_s, u, x0), driven.p, ()).x


def _largest_inputs(bound: BoundPlant) -> Array:
    return np.array([max(bound.commands(variable), key=abs) for variable in bound.model.inputs])
