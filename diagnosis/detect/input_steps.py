"""Steps of an input seen in the motion: which step's rounding errors the innovations follow."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation
from diagnosis.filter.filter_input import FilterInput
from diagnosis.filter.kalman import Disturbances
from jobs.thread_map import thread_map
from sim.model import Model
from sim.paths.path import counts_held

Array = NDArray[np.float64]
COUNT = 840  # some 0.5 % apart: 25 steps further a rounding must still fall alike
SMALLEST, LARGEST = 0.004, 0.25  # of the input's range
STEPS_APART = 1.004
ROWS = 128  # at once: with all steps side by side they stay in a processor's cache
ASKED = 40  # by what they say for the size of their errors; of these what they gain is asked


@dataclass(frozen=True)
class Kind:
    """What steps are like, in shares of one: by how much each is held beyond its half, and where they lie."""

    hold: float = 0.0
    shift: float = 0.0


@dataclass(frozen=True, eq=False)
class _Rounded:
    """An input on its way: its column, the state that it drives, and what steps may be like."""

    column: int
    target: int
    kinds: Sequence[Kind]


def likely_steps(
    linearisation: Linearisation, place: str, kinds: Sequence[Kind] = (Kind(),)
) -> list[tuple[float, Kind]]:
    """The steps q of an input, each with what it is like, whose errors explain most, to first order; a rough step hits only near the true
    one."""
    model = linearisation.case.library.bound.model
    entry = model.places.inputs[place]
    target = _target(linearisation, entry.variable)
    if target is None:
        return []
    way = _Rounded(model.inputs.index(entry.variable), target, kinds)
    steps = np.geomspace(SMALLEST, LARGEST, COUNT) * entry.size
    steps = steps[np.argsort(-_promises(linearisation, way, steps))[:ASKED]]
    by_kind = np.array([_gains(linearisation, way, steps, kind) for kind in kinds])
    found: list[tuple[float, Kind]] = []
    for index in np.argsort(-by_kind.max(axis=0)).tolist():
        step = float(steps[index])
        if all(max(step, other) > STEPS_APART * min(step, other) for other, _ in found):
            found.append((step, kinds[int(np.argmax(by_kind[:, index]))]))
        if len(found) == decisions.NEXT:
            break
    return found


@dataclass(frozen=True, eq=False)
class _Sent:
    """One log's commands, a row for as long as one stands: `u` (rows,), what the innovations say to a unit of error there, `pull`
    (rows,), and the `square` (rows,) of a unit's push."""

    u: Array
    pull: Array
    square: Array


def _promises(linearisation: Linearisation, way: _Rounded, steps: Array) -> Array:
    """The squared score (k,) of each step's errors over their sum of squares, the best of all kinds: what they gain but for how much of
    them shows, which is much alike for errors that are as good as random. Errors count in steps: a step's size cancels."""
    logs = [
        _sent(filter_input, way.column, pull)
        for filter_input, pull in zip(linearisation.filter_inputs, linearisation.pulls(way.target), strict=True)
    ]

    def by(kind: Kind) -> Array:
        score, squares = (sum(sums) for sums in zip(*(_sums(log, steps, kind) for log in logs), strict=True))
        return np.asarray(np.maximum(score, 0.0) ** 2 / np.maximum(squares, 1e-300))

    return np.asarray(np.max(thread_map(by, way.kinds), axis=0))


def _sent(filter_input: FilterInput, column: int, pull: Array) -> _Sent:
    u, h = filter_input.u[:, column], _durations_s(filter_input)
    begins = np.flatnonzero(np.diff(u, prepend=np.nan) != 0.0)
    return _Sent(u[begins], np.add.reduceat(pull * h, begins), np.add.reduceat(h * h, begins))


def _sums(log: _Sent, steps: Array, kind: Kind) -> tuple[Array, Array]:
    """Score and sum of squares (k,) of the errors of each step over one log."""
    score, squares, level = np.zeros(len(steps)), np.zeros(len(steps)), None
    for begin in range(0, len(log.u), ROWS):
        part = slice(begin, begin + ROWS)
        x = log.u[part, None] / steps + kind.shift
        held = counts_held(x, kind.hold, level)
        level = held[-1]
        x -= held
        score -= log.pull[part] @ x
        squares += log.square[part] @ np.square(x, out=x)
    return score, squares


def _gains(linearisation: Linearisation, way: _Rounded, steps: Array, kind: Kind) -> Array:
    errors = [_errors(filter_input, way.column, steps, kind) for filter_input in linearisation.filter_inputs]
    return linearisation.gains_by(errors, way.target)


def _errors(filter_input: FilterInput, column: int, steps: Array, kind: Kind) -> Disturbances:
    """Errors of an input by steps, over each of a filter input's own (instants, steps): those that the rig has move the innovations as
    its answer says; what the model would add moves them the other way."""
    x, h = filter_input.u[:, column, None] / steps + kind.shift, _durations_s(filter_input)[:, None]
    errors = steps * (x - counts_held(x, kind.hold))
    return lambda part: np.asarray(errors[part] * h[part])


def _durations_s(filter_input: FilterInput) -> Array:
    return np.append(np.diff(filter_input.t_s), 0.0)


def _target(linearisation: Linearisation, variable: sympy.Symbol) -> int | None:
    """The state by which an input shows: its rotor's speed, the speed of the axis that it pushes, or of the first that it moves through
    others, as through a current, which forgets an error before the next row; where it moves no axis, the state that it drives."""
    library = linearisation.case.library
    model = library.bound.model
    for rotor in model.places.rotors.values():
        if rotor.variable != variable:
            continue
        if rotor.drive is not None:
            return library.states.index(str(rotor.speed))
        axis = next(iter(rotor.thrusts))
        return library.states.index(next(str(entry.velocity) for entry in model.axes if entry.name == axis))
    moved = _moved_by(model, variable)
    speeds = [state for state in moved if state in [entry.velocity for entry in model.axes]]
    return next((library.states.index(str(state)) for state in (*speeds, *moved)), None)


def _moved_by(model: Model, variable: sympy.Symbol) -> list[sympy.Symbol]:
    """The states that an input moves, those first that it drives, then those that these drive, and so on."""
    rates = dict(zip(model.states, model.state_rates(), strict=True))
    moved: list[sympy.Symbol] = []
    while further := [s for s in rates if s not in moved and rates[s].free_symbols & {variable, *moved}]:
        moved += further
    return moved
