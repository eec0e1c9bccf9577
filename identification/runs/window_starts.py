"""Where a log's windows start: a guess of each state at a window's first row, and how far it may be off."""

from collections.abc import Sequence

import numpy as np
import sympy
from numpy.typing import NDArray

from records.log import RunLog
from sim.bind import BoundPlant
from sim.model import TIME, Axis, Model

Array = NDArray[np.float64]
Index = NDArray[np.int64]
SLOPE_ROWS = 4  # on either side, for a velocity guess
# A window's start may be off by so many resolution steps, or so much of its range.
POSITION_STEPS, POSITION_SHARE = 20.0, 0.05
ANYWHERE = 1.0  # rad or m, a position that was never read, of an axis without stops


def window_starts(
    bound: BoundPlant, log: RunLog, begins: Index, part: Model | None
) -> tuple[Array, tuple[str, ...], Array]:
    """Guess of each window's state, the states that are free in it, and how far the guess may be off, (windows, free).

    A position without readings about a window's first row is guessed between those that there are, and may be off by all their range;
    one that was never read, or is no output, may be anywhere between its stops. A state that is neither read nor of an axis, as a
    winding's current under its motor's voltage, is guessed where it would settle. States of the driven `part` are not free, and begin where
    that brought them: 0 here, even where they are read.
    """
    model = bound.model
    names = [str(state) for state in model.states]
    driven = {str(state) for state in part.states} if part else set()
    axes = {axis.position: axis for axis in model.axes if axis.position is not None}
    measured = tuple(model.outputs.values())
    x0, sd = np.zeros((begins.size, len(names))), np.zeros((begins.size, len(names)))
    for state, name, y in zip(measured, model.outputs, log.y.T, strict=True):
        if state not in model.states:
            continue
        step, place, axis = bound.plant.sensors[name], names.index(str(state)), axes.get(state)
        x0[:, place], slope, still, read = lines(log.t_s, y, begins, step)
        sd[:, place] = np.where(read, position_sd(y, step), max(step, _reach(y)))
        if axis is not None and not np.any(np.isfinite(y)):
            x0[:, place], sd[:, place] = _anywhere(bound, axis)
        if axis is not None and axis.velocity not in measured:
            place = names.index(str(axis.velocity))
            crawl, most = crawling(log.t_s, y, begins, step)
            x0[:, place] = np.where(still, crawl, slope)
            loose = 3.0 * max(float(np.std(slope)), float(step / np.median(np.diff(log.t_s))))
            sd[:, place] = np.where(still, most, loose)
    for position, axis in axes.items():
        if position not in measured:
            place = names.index(str(position))
            x0[:, place], sd[:, place] = _anywhere(bound, axis)
            if axis.velocity not in measured:
                sd[:, names.index(str(axis.velocity))] = _any_speed(bound, axis)
    known = {*measured, *axes, *(axis.velocity for axis in model.axes)}
    inner = [place for place, state in enumerate(model.states) if state not in known and str(state) not in driven]
    if inner:
        x0[:, inner] = settled(bound, log, begins, x0, inner)
        sd[:, inner] = np.max(np.abs(x0[:, inner]), axis=0) + np.std(x0[:, inner], axis=0)
        sd[:, inner] = np.where(sd[:, inner] > 0.0, sd[:, inner], ANYWHERE)
    x0[:, [place for place, name in enumerate(names) if name in driven]] = 0.0
    free = tuple(name for place, name in enumerate(names) if sd[0, place] > 0.0 and name not in driven)
    return x0, free, sd[:, [names.index(name) for name in free]]


def settled(bound: BoundPlant, log: RunLog, begins: Index, x0: Array, inner: Sequence[int]) -> Array:
    """Where the states at the places `inner` would settle under the other states x0 (windows, states) and the inputs at the rows
    `begins`, (windows, inner), to first order about 0; 0 where nothing holds them.
    """
    model = bound.model
    states = [model.states[place] for place in inner]
    rates = sympy.Matrix([model.rates[state] for state in states])
    values = dict(zip(model.parameter_symbols, bound.p[: len(model.parameter_symbols)].tolist(), strict=True))
    arguments = (TIME, *model.states, *model.inputs)
    at_zero = x0.copy()
    at_zero[:, list(inner)] = 0.0
    rows = np.column_stack([log.t_s[begins], at_zero, log.u[begins]])
    rate, slope = (sympy.lambdify(arguments, entry.subs(values)) for entry in (rates, rates.jacobian(states)))
    found = [-np.linalg.pinv(np.asarray(slope(*row), float)) @ np.asarray(rate(*row), float).ravel() for row in rows]
    return np.asarray(np.nan_to_num(np.array(found), posinf=0.0, neginf=0.0))


def _anywhere(bound: BoundPlant, axis: Axis) -> tuple[float, float]:
    """Mean and standard deviation of a position that may be anywhere between its stops."""
    if axis.lower is None or axis.upper is None:
        return 0.0, ANYWHERE
    lower, upper = bound.number(axis.lower), bound.number(axis.upper)
    return (lower + upper) / 2.0, (upper - lower) / np.sqrt(12.0)


def _any_speed(bound: BoundPlant, axis: Axis) -> float:
    """Standard deviation of the velocity of an axis that no output shows alone: what is usual for it."""
    place = bound.model.places.axes.get(axis.name)
    return place.speed_size if place else ANYWHERE


def position_sd(y: Array, step: float) -> float:
    """How far the guess of a position may be off: a loose hold, as the readings say it themselves."""
    return max(POSITION_STEPS * step, POSITION_SHARE * _reach(y))


def _reach(y: Array) -> float:
    good = y[np.isfinite(y)]
    return float(np.ptp(good)) if good.size else 0.0


def lines(
    t_s: Array, y: Array, begins: Index, step: float
) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Value and slope at the rows `begins` of a line through the rows around each; whether these show no motion, and whether any line.

    Where fewer than two of them were read the value lies between the nearest that were, its slope is 0.
    """
    known = np.isfinite(y)
    level = np.interp(t_s[begins], t_s[known], y[known]) if known.any() else np.zeros(begins.size)
    slope = np.zeros(begins.size)
    still, read = np.zeros(begins.size, dtype=bool), np.zeros(begins.size, dtype=bool)
    for number, row in enumerate(begins):
        near = np.arange(max(0, row - SLOPE_ROWS), min(t_s.size, row + SLOPE_ROWS + 1))
        near = near[known[near]]
        read[number] = near.size > 1
        if read[number]:
            slope[number], level[number] = np.polyfit(t_s[near] - t_s[row], y[near], 1)
            still[number] = np.ptp(y[near]) < 0.5 * step
    return level, slope, still, read


def crawling(t_s: Array, y: Array, begins: Index, step: float) -> tuple[Array, Array]:
    """Guess and bound of the velocity at the rows `begins` of what shows no motion there: it may crawl within one resolution step.

    It has not left the step since the reading last changed and until it changes next, or the log ends. Where both changes go the same
    way it has crossed the step in between; otherwise it may as well rest. What stood for a minute may also be setting out: s from rest
    under constant acceleration until it has crossed the step a time T after the row, its speed there is step s / (s + T)^2, at most
    step / (4 T); and coming to rest likewise, T after a change.
    """
    known = np.flatnonzero(np.isfinite(y))
    jumps = np.diff(y[known])
    changed = np.abs(jumps) >= 0.5 * step
    edges_s = (0.5 * (t_s[known[1:]] + t_s[known[:-1]]))[changed]
    ways = np.concatenate([[0.0], np.sign(jumps[changed]), [0.0]])
    after = 1 + np.searchsorted(edges_s, t_s[begins], side="right")
    ends_s, changes_s = (
        np.concatenate([[first], edges_s, [last]]) for first, last in ((t_s[0], t_s[-1]), (-np.inf, np.inf))
    )
    shortest_s = np.median(np.diff(t_s))
    crossed = step / np.maximum(ends_s[after] - ends_s[after - 1], shortest_s)
    nearer_s = np.minimum(changes_s[after] - t_s[begins], t_s[begins] - changes_s[after - 1])
    most = np.maximum(crossed, step / (4.0 * np.maximum(nearer_s, shortest_s)))
    return np.where(ways[after] == ways[after - 1], ways[after], 0.0) * crossed, most
