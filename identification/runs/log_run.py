"""A run log as a run for the estimator: cut into windows whose starts are free, which holds an unstable plant to its data."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from identification.model.driven import driven_model
from identification.model.motion import move
from identification.model.subsystem import subsystem
from identification.runs.run import Carried, Run
from identification.runs.window_starts import window_starts
from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant

Array = NDArray[np.float64]
FORGOTTEN = 2e-4  # of a driven state's reach: ten times that, as thrust, is as much as good bearings' friction, and moved J_E by 8 sd
MOST_WAITED = 0.25  # of a log, until how its driven states began no longer shows; in a shorter one that is estimated


def log_run(
    bound: BoundPlant, log: RunLog, name: str, window_s: float, every: int = 1, at_first: ArrayLike | None = None
) -> Run:
    """The measured outputs of a log as readings, windows of `window_s` (inf: one for the whole log), of which each `every`th is kept.

    A reading's error is that of `rounding_sd`. Rows where nothing was measured give no reading. States that only the inputs drive run on
    from those of `at_first` (states,) at the first row; where these are not given a log is used once they no longer matter, and one that
    is too short for that with their starts free in each window. Raises BadInput for a log with less than two rows or without readings,
    or a plant with effects on the way of its inputs or outputs.
    """
    _check(bound, log, name)
    model, driven = bound.model, _driven(bound, log, at_first)
    begins, stops = _windows(log.t_s, window_s, every, driven.known_after_s)
    used = np.concatenate([np.arange(a, b) for a, b in zip(begins, stops, strict=True)])
    rows = np.isfinite(log.y) & np.isin(np.arange(log.t_s.size), used)[:, None]
    select = np.flatnonzero(rows.ravel())
    channel = select % log.y.shape[1]
    step = np.array([bound.plant.sensors[output] for output in model.outputs])
    noise = np.array([bound.plant.sensor_noise.get(output, 0.0) for output in model.outputs])
    x0, free, start_sd = window_starts(bound, log, begins, driven_model(model))
    return Run(
        name=name,
        bound=bound,
        t_s=log.t_s,
        u=log.u,
        y=log.y.ravel()[select],
        sd=_sds(log.y.ravel()[select], channel, step, noise),
        at_s=log.t_s[select // log.y.shape[1]],
        channel=channel,
        channels=tuple(model.outputs),
        select=select,
        begins=begins,
        stops=stops,
        x0=x0,
        free=(*free, *driven.free),
        start_sd=np.hstack([start_sd, driven.sd[begins]]),
        carried=driven.carried,
        step=step,
    )


def _check(bound: BoundPlant, log: RunLog, name: str) -> None:
    if log.t_s.size < 2:
        raise BadInput("log", name, f"{log.t_s.size} row", "at least two rows", "give a longer log")
    if not np.any(np.isfinite(log.y)):
        got = f"no number of {', '.join(log.columns.outputs)} in {log.t_s.size} rows"
        raise BadInput(
            "readings", name, got, "a reading of at least one output", "give a log in which something was measured"
        )
    if bound.input_path or bound.output_path:
        raise BadInput(
            "effects", bound.plant.name, "effects on the way of an input or output", "effects in the equations alone",
            "identify from the plant without them",
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Driven:
    """States that only the inputs drive: where they run on from, how long until that is known, or which are free and by how much.

    sd (n, free) is how far off they may be at each row.
    """

    carried: Carried | None
    known_after_s: float
    free: tuple[str, ...]
    sd: Array


def _driven(bound: BoundPlant, log: RunLog, at_first: ArrayLike | None) -> _Driven:
    model, part, known = bound.model, driven_model(bound.model), np.zeros((log.t_s.size, 0))
    if part is None:
        return _Driven(None, 0.0, (), known)
    own = subsystem(bound, part)
    if at_first is not None:
        x0 = np.asarray(at_first, dtype=float)[[model.states.index(state) for state in part.states]]
        return _Driven(Carried(own, x0), 0.0, (), known)
    u = np.ascontiguousarray(log.u[:, [model.inputs.index(variable) for variable in part.inputs]])
    rest = np.zeros(len(part.states))
    forgotten_s = _forgotten_s(own, log.t_s, u)
    if forgotten_s <= MOST_WAITED * (log.t_s[-1] - log.t_s[0]):
        return _Driven(Carried(own, rest), forgotten_s, (), known)
    held = _run_on(own, log.t_s, np.tile(u[0], (log.t_s.size, 1)), rest)[-1]
    return _Driven(Carried(own, held), 0.0, tuple(map(str, part.states)), _left_of_others(own, log.t_s, u, held))


def _forgotten_s(driven: BoundPlant, t_s: Array, u: Array) -> float:
    """How long after the first row it still shows with what states the log began: two runs from far starts are compared."""
    still = _run_on(driven, t_s, u, np.zeros(len(driven.model.states)))
    reach = np.max(np.abs(still), axis=0)
    apart = np.flatnonzero(np.any(np.abs(_run_on(driven, t_s, u, reach) - still) > FORGOTTEN * reach, axis=1))
    return float(t_s[apart[-1]] - t_s[0]) if apart.size else 0.0


def _left_of_others(driven: BoundPlant, t_s: Array, u: Array, x0: Array) -> Array:
    """What is left, row by row (n, driven), of a start as far from x0 (driven,) as any inputs could have brought it."""
    largest = np.tile(_largest_inputs(driven), (t_s.size, 1))
    reach = np.max(np.abs(_run_on(driven, t_s, largest, np.zeros(x0.size))), axis=0)
    left = np.abs(_run_on(driven, t_s, u, x0 + reach) - _run_on(driven, t_s, u, x0))
    return np.asarray(np.maximum(left, FORGOTTEN * reach))


def _run_on(driven: BoundPlant, t_s: Array, u: Array, x0: Array) -> Array:
    return move(driven.model, t_s, u, driven.p, (slice(0, t_s.size),), x0[None, :], ()).x


def _largest_inputs(bound: BoundPlant) -> Array:
    return np.array([max(bound.limits(variable), key=abs) for variable in bound.model.inputs])


def _sds(y: Array, channel: NDArray[np.int64], step: Array, noise: Array) -> Array:
    sd = np.empty(y.size)
    for number in range(step.size):
        mine = channel == number
        sd[mine] = rounding_sd(y[mine], float(step[number]), float(noise[number]))
    return sd


def rounding_sd(readings: Array, step: float, noise: float = 0.0) -> Array:
    """Standard deviation of each of the readings (n,) of one sensor: step / sqrt(12) and its noise.

    A reading that repeats m times in a row has one rounding error, not m independent ones; each counts for an m-th of a reading.
    """
    changed = np.flatnonzero(np.diff(readings, prepend=np.nan) != 0.0)
    lengths = np.diff(np.append(changed, readings.size))
    repeats = np.repeat(lengths, lengths) if readings.size else np.zeros(0)
    return np.sqrt(step**2 / 12.0 * repeats + noise**2)


def _windows(t_s: Array, window_s: float, every: int, from_s: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First rows of windows of about `window_s`, and the rows behind their last; `from_s` at the beginning is left out."""
    first_s = t_s[0] + from_s
    count = max(1, round((t_s[-1] - first_s) / window_s)) if np.isfinite(window_s) else 1
    edges = first_s + (t_s[-1] - first_s) * np.arange(count) / count
    begins = np.unique(np.searchsorted(t_s, edges - 1e-9)).astype(np.int64)
    stops = np.append(begins[1:], t_s.size).astype(np.int64)
    return begins[::every], stops[::every]
