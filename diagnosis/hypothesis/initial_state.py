"""Where a flight starts: what its first readings say of the state, and whether what nobody read had run up already."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.filter_input import FilterInput, beginning
from diagnosis.filter.kalman import FilterNoise, Wanted
from diagnosis.library.effect_library import EffectLibrary
from logcheck import thresholds

Array = NDArray[np.float64]
START_S = 0.1
LONGEST_STEP_S = 0.01
FIRST_REST_DOUBT = -1.7  # log10 s: how long friction about rest is in doubt, from where every fit of it starts


def start_of(library: EffectLibrary, filter_input: FilterInput, locked: tuple[str, ...]) -> tuple[Array, Array]:
    """Where a flight starts and its variances (states,): angles as first read, speeds as they then change, other states at rest under
    the first inputs, or short of it where the plant then follows the first readings better."""
    x0, p0, unread = _first_guess(library, filter_input)
    early = beginning(filter_input, decisions.UNTOLD_S)
    instants = len(early.t_s)
    early = replace(early, rows=instants, place=np.where(np.isfinite(early.y), np.arange(instants)[:, None], -1))
    value = _likelihood(library, early, x0, p0, locked)
    for index in unread:
        rest = x0[index]
        for share in decisions.REST_SHARES:
            other = x0.copy()
            other[index] = share * rest
            fitted = _likelihood(library, early, other, p0, locked)
            if fitted > value:
                x0, value = other, fitted
    return x0, p0


def _first_guess(library: EffectLibrary, filter_input: FilterInput) -> tuple[Array, Array, list[int]]:
    """Start and variances (states,), and the states that are neither read nor a speed, which are at rest under the first inputs.

    A state may start as far from there as START_SHARE of what it does: an angle of the range of its readings, a speed of the largest that
    they show, another state of its rest.
    """
    model = library.bound.model
    x0, farthest = np.zeros(len(library.states)), np.zeros(len(library.states))
    read, speeds = dict[str, tuple[float, float]](), {str(axis.velocity): str(axis.position) for axis in model.axes}
    for place, expression in enumerate(model.outputs.values()):
        good = np.isfinite(filter_input.y[:, place])
        if str(expression) in library.states and good.any():
            index, error = library.states.index(str(expression)), float(np.sqrt(filter_input.single[place]))
            t_s, y = filter_input.t_s[good], filter_input.y[good, place]
            x0[index], farthest[index] = y[0], max(float(np.ptp(y)), error)
            read[str(expression)] = _speeds(t_s, y, error)
    rest = _rest(library, filter_input, x0)
    unread = []
    for index, state in enumerate(library.states):
        if state in read:
            continue
        if speeds.get(state) in read:
            x0[index], farthest[index] = read[speeds[state]]
        else:
            x0[index] = rest[index]
            farthest[index] = max(abs(rest[index]), 0.5 * float(np.max(np.abs(rest))), 1e-3)
            unread.append(index)
    return x0, np.maximum((decisions.START_SHARE * farthest) ** 2, 1e-12), unread


def _speeds(t_s: Array, y: Array, error: float) -> tuple[float, float]:
    """The first speed of readings y (n,) at t_s (n,) with such an `error`, and the largest, each over START_S."""
    early = t_s - t_s[0] <= START_S
    first = float(np.polyfit(t_s[early], y[early], 1)[0]) if early.sum() > 2 else 0.0
    later = np.searchsorted(t_s, t_s + START_S - 1e-9)
    inside = later < len(t_s)
    ways = np.abs(y[later[inside]] - y[inside]) / (t_s[later[inside]] - t_s[inside])
    return first, max(float(np.max(ways, initial=0.0)), error / START_S)


def _likelihood(
    library: EffectLibrary, filter_input: FilterInput, x0: Array, p0: Array, locked: tuple[str, ...]
) -> float:
    """How well the plant without effects follows a filter input from a start, with the process noise of before any log was seen."""
    none = np.zeros(library.plain.filter.states)
    q = none.copy()
    q[list(library.velocities)] = 10.0 ** (2.0 * decisions.FIRST_PROCESS_NOISE)
    rub = np.full(max(1, len(library.plain.filter.axes)), 10.0**FIRST_REST_DOUBT)
    noise = FilterNoise(q, rub, _padded(p0, none), none, none, float(np.median(np.diff(filter_input.t_s))))
    run = library.plain.filter.run(
        filter_input, library.plain.p, _padded(x0, none), noise, Wanted(range(filter_input.y.shape[1])), locked
    )
    return -np.inf if run is None or not np.isfinite(run.log_likelihood) else run.log_likelihood


def _rest(library: EffectLibrary, filter_input: FilterInput, x0: Array) -> Array:
    """States after a while under the first inputs with every axis held; as they are where the plant leaves all bounds."""
    step_s = min(LONGEST_STEP_S, float(np.median(np.diff(filter_input.t_s))))
    t_s = np.arange(0.0, thresholds.RUN_UP_S + step_s, step_s)
    read = np.full((len(t_s), filter_input.y.shape[1]), np.nan)
    blind = replace(
        filter_input,
        t_s=t_s,
        u=np.tile(filter_input.u[filter_input.t_s - filter_input.t_s[0] <= START_S].mean(axis=0), (len(t_s), 1)),
        y=read,
        r=np.ones_like(read),
        row=np.arange(len(t_s)),
        place=np.full(read.shape, -1),
        rows=len(t_s),
        untold_s=np.zeros(len(t_s)),
    )
    compiled, none = library.plain, np.zeros(library.plain.filter.states)
    axes = compiled.filter.axes
    low_noise = FilterNoise(none, np.zeros(max(1, len(axes))), none, none, none, step_s)
    run = compiled.filter.run(blind, compiled.p, _padded(x0, none), low_noise, Wanted([-1] * read.shape[1]), axes)
    return x0 if run is None else run.x[-1, : len(x0)]


def _padded(own: Array, none: Array) -> Array:
    """The plant's own states with those that a filter has beside them, at rest."""
    return np.append(own, none[len(own) :])
