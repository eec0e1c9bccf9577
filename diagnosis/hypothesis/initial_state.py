"""Where a flight starts: what its first readings say of the state, and whether what nobody read had run up already."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.filter_input import FilterInput, beginning
from diagnosis.filter.kalman import Noise
from diagnosis.library.effect_library import EffectLibrary

Array = NDArray[np.float64]
START_S = 0.1
RUN_UP_S, LONGEST_STEP_S = 4.0, 0.01
FIRST_REST_DOUBT = -1.7  # log10 s: how long friction about rest is in doubt, from where every fit of it starts


def start_of(library: EffectLibrary, filter_input: FilterInput, locked: tuple[str, ...]) -> tuple[Array, Array]:
    """Where a flight starts and its variances (states,): angles as first read, speeds as they then change, other states at rest under
    the first inputs, or short of it where the plant then follows the first readings better."""
    x0, p0, unread = _first_guess(library, filter_input)
    early = beginning(filter_input, decisions.JUDGED_START_S)
    instants = len(early.t_s)
    early = replace(early, rows=instants, place=np.where(np.isfinite(early.y), np.arange(instants)[:, None], -1))
    value = _likelihood(library, early, x0, p0, locked)
    for index in unread:
        for share in decisions.REST_SHARES:
            other = x0.copy()
            other[index] = share * unread[index]
            fitted = _likelihood(library, early, other, p0, locked)
            if fitted > value:
                x0, value = other, fitted
    return x0, p0


def _first_guess(library: EffectLibrary, filter_input: FilterInput) -> tuple[Array, Array, dict[int, float]]:
    """Start and variances (states,), and the states that are neither read nor a speed, each with its rest under the first inputs."""
    model = library.bound.model
    positions, x0 = {}, np.zeros(len(library.states))
    p0 = np.full(len(library.states), 1e-12)
    early = filter_input.t_s - filter_input.t_s[0] <= START_S
    for place, (name, expression) in enumerate(model.outputs.items()):
        y = filter_input.y[early, place]
        good = np.isfinite(y)
        if str(expression) not in library.states or not good.any():
            continue
        index = library.states.index(str(expression))
        x0[index], p0[index] = y[good][0], decisions.START_ANGLE**2
        slope = np.polyfit(filter_input.t_s[early][good], y[good], 1)[0] if good.sum() > 2 else 0.0
        positions[str(expression)] = (name, float(slope))
    speeds = {str(axis.velocity): str(axis.position) for axis in model.axes}
    rest = _rest(library, filter_input, x0)
    unread = {}
    for index, state in enumerate(library.states):
        if state in positions:
            continue
        if state in speeds:
            x0[index] = positions.get(speeds[state], ("", 0.0))[1]
            p0[index] = decisions.START_SPEED**2
        else:
            x0[index] = unread[index] = float(rest[index])
            p0[index] = (decisions.START_SHARE * max(abs(rest[index]), 0.5 * float(np.max(np.abs(rest))), 1e-3)) ** 2
    return x0, p0, unread


def _likelihood(
    library: EffectLibrary, filter_input: FilterInput, x0: Array, p0: Array, locked: tuple[str, ...]
) -> float:
    """How well the plant without effects follows a filter input from a start, with the process noise of before any log was seen."""
    none = np.zeros(library.plain.filter.states)
    q = none.copy()
    q[list(library.velocities)] = 10.0 ** (2.0 * decisions.FIRST_PROCESS_NOISE)
    rub = np.full(max(1, len(library.plain.filter.axes)), 10.0**FIRST_REST_DOUBT)
    noise = Noise(q, rub, _padded(p0, none), none, none, float(np.median(np.diff(filter_input.t_s))))
    run = library.plain.filter.run(
        filter_input, library.plain.p, _padded(x0, none), noise, range(filter_input.y.shape[1]), locked=locked
    )
    return -np.inf if run is None or not np.isfinite(run.log_likelihood) else run.log_likelihood


def _rest(library: EffectLibrary, filter_input: FilterInput, x0: Array) -> Array:
    """States after a while under the first inputs with every axis held; as they are where the plant leaves all bounds."""
    step_s = min(LONGEST_STEP_S, float(np.median(np.diff(filter_input.t_s))))
    t_s = np.arange(0.0, RUN_UP_S + step_s, step_s)
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
    low_noise = Noise(none, np.zeros(max(1, len(axes))), none, none, none, step_s)
    run = compiled.filter.run(blind, compiled.p, _padded(x0, none), low_noise, [-1] * read.shape[1], locked=axes)
    return x0 if run is None else run.x[-1, : len(x0)]


def _padded(own: Array, none: Array) -> Array:
    """The plant's own states with those that a filter has beside them, at rest."""
    return np.append(own, none[len(own) :])
