"""Many parameter sets on one problem: what each predicts, side by side in the compiled kernel where the runs allow it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from identification.fit.problem import Problem
from identification.runs.prediction import predicted
from identification.runs.run import Run, coefficient_names, known_names
from sim.simulate import Conditions, simulate

Array = NDArray[np.float64]
DEGREES = 180.0 / np.pi
TENTH = 10.0


def absolute_error(problem: Problem, thetas: Array) -> Array:
    """J = sum |y - y_hat| of seed 001 for each of the parameter sets thetas (sets, parameters); infinite for a motion without end.

    Angles count in degrees, as in the paper; other readings in tenths of their spread. Windows start at their guesses.
    """
    total = np.zeros(len(thetas))
    for run in problem.runs:
        error = np.abs(run.y - predictions(run, problem.names, thetas)) @ _units(run)
        total += np.where(np.isfinite(error), error, np.inf)
    return total


def predictions(run: Run, names: Sequence[str], thetas: Array) -> Array:
    """The predicted readings (sets, m), in their units."""
    with np.errstate(over="ignore", invalid="ignore"):
        if _is_plain(run):
            return _at_once(run, names, thetas)
        return np.stack([predicted(run, names, theta) for theta in thetas])


def _is_plain(run: Run) -> bool:
    """One window from the first row on, and readings that are outputs: what the batched kernel does."""
    whole = run.begins.size == 1 and run.begins[0] == 0 and run.stops[0] == run.t_s.size
    return whole and run.observed is None and isinstance(run.select, np.ndarray)


def _at_once(run: Run, names: Sequence[str], thetas: Array) -> Array:
    model, p = run.bound.model, np.tile(run.bound.p, (len(thetas), 1))
    known = coefficient_names(model)
    for place, name in known_names(run, names):
        if name in known:
            p[:, known.index(name)] = thetas[:, place]
    x0 = run.x0[0].copy()
    if run.carried is not None:
        x0[[model.states.index(state) for state in run.carried.bound.model.states]] = run.carried.x0
    exact = np.zeros(len(model.outputs))
    y = simulate(run.bound, run.t_s, x0, run.u, Conditions(p=p, resolution=exact, keep="y")).y
    assert y is not None
    return np.asarray(y.reshape(len(thetas), -1)[:, run.select])


def _units(run: Run) -> Array:
    """What one unit of each reading (m,) counts."""
    found = np.empty(run.y.size)
    for number, channel in enumerate(run.channels):
        mine = run.channel == number
        spread = float(np.std(run.y[mine])) if mine.any() else 0.0
        found[mine] = DEGREES if channel.endswith("_rad") else TENTH / (spread or 1.0)
    return found
