"""Where a flight starts: what its first readings say of the state, and whether what nobody read had run up already."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import Tape, beginning
from diagnosis.filter.kalman import Noise
from diagnosis.library.effect_library import Kit

Array = NDArray[np.float64]
START_S = 0.1
RUN_UP_S, LONGEST_STEP_S = 4.0, 0.01
FIRST_UNREST = -1.5  # before any log was seen
START_ANGLE = 0.1  # how far an output may be from its first reading, which may be late or off
START_SPEED = 1.0  # how far from rest a speed may be at the start, per s, in units of the output
START_SHARE = 0.6  # how far from where it is begun another state may be, as a share of its rest under the first inputs
REST_SHARES = (0.0, 0.5)  # of that rest, from which such a state is begun too: logs often start before the rotors do,
JUDGED_S = 3.0  # and so long what is read tells
RUB_S = 0.02  # how long friction about rest is in doubt


def start_of(kit: Kit, tape: Tape, locked: tuple[str, ...]) -> tuple[Array, Array]:
    """Where a flight starts and its variances (states,): angles as first read, speeds as they then change, other states at rest under
    the first inputs, or short of it where the plant then follows the first readings better."""
    x0, p0, unread = _first_guess(kit, tape)
    early = beginning(tape, JUDGED_S)
    early = replace(early, place=np.where(np.isfinite(early.y), np.arange(early.rows)[:, None], -1))
    value = _likelihood(kit, early, x0, p0, locked)
    for index in unread:
        for share in REST_SHARES:
            other = x0.copy()
            other[index] = share * unread[index]
            tried = _likelihood(kit, early, other, p0, locked)
            if tried > value:
                x0, value = other, tried
    return x0, p0


def _first_guess(kit: Kit, tape: Tape) -> tuple[Array, Array, dict[int, float]]:
    """Start and variances (states,), and the states that are neither read nor a speed, each with its rest under the first inputs."""
    model = kit.bound.model
    positions, x0 = {}, np.zeros(len(kit.states))
    p0 = np.full(len(kit.states), 1e-12)
    early = tape.t_s - tape.t_s[0] <= START_S
    for place, (name, expression) in enumerate(model.outputs.items()):
        y = tape.y[early, place]
        good = np.isfinite(y)
        if str(expression) not in kit.states or not good.any():
            continue
        index = kit.states.index(str(expression))
        x0[index], p0[index] = y[good][0], START_ANGLE**2
        slope = np.polyfit(tape.t_s[early][good], y[good], 1)[0] if good.sum() > 2 else 0.0
        positions[str(expression)] = (name, float(slope))
    speeds = {str(axis.velocity): str(axis.position) for axis in model.axes}
    rest = _rest(kit, tape, x0)
    unread = {}
    for index, state in enumerate(kit.states):
        if state in positions:
            continue
        if state in speeds:
            x0[index] = positions.get(speeds[state], ("", 0.0))[1]
            p0[index] = START_SPEED**2
        else:
            x0[index] = unread[index] = float(rest[index])
            p0[index] = (START_SHARE * max(abs(rest[index]), 0.5 * float(np.max(np.abs(rest))), 1e-3)) ** 2
    return x0, p0, unread


def _likelihood(kit: Kit, tape: Tape, x0: Array, p0: Array, locked: tuple[str, ...]) -> float:
    """How well the plant without effects follows a tape from a start, in air as restless as before any log was seen."""
    q, none = np.zeros(len(x0)), np.zeros(len(x0))
    q[list(kit.velocities)] = 10.0 ** (2.0 * FIRST_UNREST)
    rub = np.full(max(1, len(kit.plain.filter.axes)), RUB_S)
    noise = Noise(q, rub, p0, none, float(np.median(np.diff(tape.t_s))))
    run = kit.plain.filter.run(tape, kit.plain.p, x0, noise, range(tape.y.shape[1]), locked=locked)
    return -np.inf if run is None or not np.isfinite(run.log_likelihood) else run.log_likelihood


def _rest(kit: Kit, tape: Tape, x0: Array) -> Array:
    """States after a while under the first inputs with every axis held; as they are where the plant leaves all bounds."""
    step_s = min(LONGEST_STEP_S, float(np.median(np.diff(tape.t_s))))
    t_s = np.arange(0.0, RUN_UP_S + step_s, step_s)
    read = np.full((len(t_s), tape.y.shape[1]), np.nan)
    blind = replace(
        tape,
        t_s=t_s,
        u=np.tile(tape.u[tape.t_s - tape.t_s[0] <= START_S].mean(axis=0), (len(t_s), 1)),
        y=read,
        r=np.ones_like(read),
        row=np.arange(len(t_s)),
        place=np.full(read.shape, -1),
        rows=len(t_s),
        untold_s=np.zeros(len(t_s)),
    )
    variant, none = kit.plain, np.zeros(len(x0))
    axes = variant.filter.axes
    calm = Noise(none, np.zeros(max(1, len(axes))), none, none, step_s)
    run = variant.filter.run(blind, variant.p, x0, calm, [-1] * read.shape[1], locked=axes)
    return x0 if run is None else run.x[-1]
