"""Steps of an input seen in the motion: which step's rounding errors the innovations follow."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation
from diagnosis.filter.filter_input import FilterInput
from diagnosis.filter.kalman import Disturbances
from jobs.thread_map import thread_map
from sim.paths.path import in_held_steps_of_each

Array = NDArray[np.float64]
COUNT = 840  # some 0.5 % apart: 25 steps further a rounding must still fall alike
SMALLEST, LARGEST = 0.004, 0.25  # of the input's range
STEPS_APART = 1.004
AT_ONCE = 280  # side by side: time
ASKED = 40  # by what they say for the size of their errors; of these what they gain is asked


@dataclass(frozen=True, eq=False)
class _Rounded:
    """An input on its way: its column, the state that it drives, and the shares of a step by which each is held beyond its half."""

    column: int
    target: int
    holds: Sequence[float]


def likely_steps(linearisation: Linearisation, place: str, holds: Sequence[float] = (0.0,)) -> list[float]:
    """The steps q of an input whose errors explain most, to first order, each held by one of the shares `holds` of it beyond its half; a
    rough step hits only near the true one."""
    model = linearisation.case.library.bound.model
    entry = model.places.inputs[place]
    target = _target(linearisation, entry.variable)
    if target is None:
        return []
    way = _Rounded(model.inputs.index(entry.variable), target, holds)
    steps = np.geomspace(SMALLEST, LARGEST, COUNT) * entry.size
    steps = steps[np.argsort(-_promises(linearisation, way, steps))[:ASKED]]
    gains = np.max([_gains(linearisation, way, steps, hold) for hold in holds], axis=0)
    found: list[float] = []
    for index in np.argsort(-gains).tolist():
        step = float(steps[index])
        if all(max(step, other) > STEPS_APART * min(step, other) for other in found):
            found.append(step)
        if len(found) == decisions.NEXT:
            break
    return found


def _promises(linearisation: Linearisation, way: _Rounded, steps: Array) -> Array:
    """The squared score (k,) of each step's errors over their sum of squares, the best of all `holds`: what they gain but for how much of
    them shows, which is much alike for errors that are as good as random."""
    pulls = linearisation.pulls(way.target)
    parts = np.split(steps, len(steps) // AT_ONCE)

    def over(part: Array, hold: float) -> Array:
        score, squares = np.zeros(len(part)), np.zeros(len(part))
        for filter_input, pull in zip(linearisation.filter_inputs, pulls, strict=True):
            pushed = _errors(filter_input, way.column, part, hold)(slice(None))
            score, squares = score - pull @ pushed, squares + np.einsum("ij,ij->j", pushed, pushed)
        return np.asarray(np.maximum(score, 0.0) ** 2 / np.maximum(squares, 1e-300))

    by_hold = [np.concatenate(thread_map(partial(over, hold=hold), parts)) for hold in way.holds]
    return np.asarray(np.max(by_hold, axis=0))


def _gains(linearisation: Linearisation, way: _Rounded, steps: Array, hold: float) -> Array:
    errors = [_errors(filter_input, way.column, steps, hold) for filter_input in linearisation.filter_inputs]
    return linearisation.gains_by(errors, way.target)


def _errors(filter_input: FilterInput, column: int, steps: Array, hold: float) -> Disturbances:
    """Errors of an input by steps, over each of a filter input's own (instants, steps): those that the rig has move the innovations as
    its answer says; what the model would add moves them the other way."""
    u, h = filter_input.u[:, column, None], np.append(np.diff(filter_input.t_s), 0.0)[:, None]
    reached = in_held_steps_of_each(u[:, 0], steps, hold)

    def disturbance(part: slice) -> Array:
        errors: Array = u[part] - reached[part]
        pushed: Array = errors * h[part]
        return pushed

    return disturbance


def _target(linearisation: Linearisation, variable: sympy.Symbol) -> int | None:
    """The state that an input drives: its rotor's speed, or the speed of the axis that it pushes."""
    library = linearisation.case.library
    for rotor in library.bound.model.places.rotors.values():
        if rotor.variable != variable:
            continue
        if rotor.drive is not None:
            return library.states.index(str(rotor.speed))
        axis = next(iter(rotor.thrusts))
        return library.states.index(
            next(str(entry.velocity) for entry in library.bound.model.axes if entry.name == axis)
        )
    return None
