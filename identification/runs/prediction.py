"""Predicted readings of a run and their exact derivatives by parameters and by the starts of its windows."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.runs.run import Run, coefficient_names, inputs_of, known_names, offset_names, parameters_of
from sim.runs.sensitivities import Given, Sensitivities, sensitivities, whole

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Block:
    """Readings of one window, divided by their standard deviations: residual y - y_hat (m,), the prediction's slopes by the parameters
    (m, parameters) and by the window's free starts (m, free), times at_s (m,), and where they stand among the run's readings.
    """

    residual: Array
    by_parameter: Array
    by_start: Array
    at_s: Array
    place: slice


def blocks(run: Run, names: Sequence[str], theta: Array) -> tuple[Block, ...]:
    """All windows of a run predicted with the parameters `names` at theta (parameters,)."""
    own = known_names(run, names)
    p, u = parameters_of(run, names, theta), inputs_of(run, names, theta)
    y, slopes = _readings(run, p, u, tuple(name for _, name in own))
    residual, slopes = (run.y - y) / run.sd, slopes / run.sd[:, None]
    by_parameter = np.zeros((run.y.size, len(names)))
    by_parameter[:, [place for place, _ in own]] = slopes[:, : len(own)]
    by_start = slopes[:, len(own) :]
    return tuple(
        Block(residual[place], by_parameter[place], by_start[place], run.at_s[place], place)
        for place in run.window_readings
    )


def predicted(run: Run, names: Sequence[str], theta: Array) -> Array:
    """The predicted readings (m,) alone, in their units."""
    return _readings(run, parameters_of(run, names, theta), inputs_of(run, names, theta), ())[0]


def _readings(run: Run, p: Array, u: Array, columns: tuple[str, ...]) -> tuple[Array, Array]:
    """Readings (m,) and their slopes (m, columns + free)."""
    starts = tuple(f"x0.{state}" for state in run.free)
    if run.carried is None:
        given = Given(run.t_s, u, run.windows, run.x0, run.substeps)
        motion = sensitivities(run.bound.model, given, p, columns + starts)
    else:
        motion = _with_carried(run, p, u, columns, starts)
    y, slopes = (motion.y, motion.dy) if run.observed is None else _observed(run, p, u, motion)
    flat_y, flat_slopes = y.ravel(), slopes.reshape(y.size, -1)
    if isinstance(run.select, np.ndarray):
        return flat_y[run.select], flat_slopes[run.select]
    return run.select @ flat_y, run.select @ flat_slopes


def _with_carried(run: Run, p: Array, u: Array, columns: tuple[str, ...], starts: tuple[str, ...]) -> Sensitivities:
    """The windows with their carried states put in: these follow from the whole run before, and so do their slopes."""
    assert run.carried is not None
    model, part = run.bound.model, run.carried.bound.model
    known = coefficient_names(model)
    own = coefficient_names(part)
    inputs = [model.inputs.index(variable) for variable in part.inputs]
    values = np.ascontiguousarray(p[[known.index(name) for name in own]])
    before = replace(whole(run.t_s, u[:, inputs], run.carried.x0), substeps=run.substeps)
    wanted = tuple(name for name in columns if name in own or name in offset_names(part))
    carried = sensitivities(part, before, values, wanted)
    x0 = run.x0.copy()
    x0[:, [model.states.index(state) for state in part.states]] += carried.x[run.begins]
    through = tuple(f"x0.{state}" for state in part.states)
    kept = columns + starts
    every = (*kept, *(name for name in through if name not in kept))
    motion = sensitivities(model, Given(run.t_s, u, run.windows, x0, run.substeps), p, every)
    slopes = motion.dy[:, :, : len(kept)].copy()
    places, passing = [columns.index(name) for name in wanted], [every.index(name) for name in through]
    for rows, begin in zip(run.windows, run.begins, strict=True):
        slopes[rows][:, :, places] += motion.dy[rows][:, :, passing] @ carried.dy[begin]
    return Sensitivities(kept, motion.y, slopes, motion.x)


def _observed(run: Run, p: Array, u: Array, motion: Sensitivities) -> tuple[Array, Array]:
    """What the sensors show, with slopes through the state and directly by the parameters; the model's outputs are all its states."""
    h, names = run.observed, coefficient_names(run.bound.model)
    assert h is not None
    slopes = h.by_state(motion.x, u, p) @ motion.dy
    direct = h.by_parameter(motion.x, u, p)
    for column, name in enumerate(motion.columns):
        if name in names:
            slopes[:, :, column] += direct[:, :, names.index(name)]
    return h.value(motion.x, u, p), slopes
