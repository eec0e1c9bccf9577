"""A run log as a run for the estimator: cut into windows whose starts are free, which holds an unstable plant to its data."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from identification.model.driven import driven_model
from identification.model.locked import locked_model
from identification.model.subsystem import subsystem
from identification.runs.driven_start import driven_start
from identification.runs.rows import behind_missing_rows, read_again
from identification.runs.run import Run
from identification.runs.window_starts import window_starts
from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import log_columns

Array = NDArray[np.float64]


def log_run(
    bound: BoundPlant, log: RunLog, name: str, window_s: float, every: int = 1, at_first: ArrayLike | None = None
) -> Run:
    """The measured outputs of a log as readings, windows of `window_s` (inf: one for the whole log), of which each `every`th is kept; none
    runs over missing rows, and another begins where an output is read again.

    A reading's error is that of `rounding_sd`. Rows where nothing was measured give no reading. States that only the inputs drive run on
    from those of `at_first` (states,) at the first row; where these are not given a log is used once they no longer matter, and one that
    is too short for that with their starts free in each window. Raises BadInput for a log with less than two rows or without readings,
    or a plant with effects on the way of its inputs or outputs.
    """
    _check(bound, log, name)
    model, driven = bound.model, driven_start(bound, log, at_first)
    begins, stops = _windows(log, window_s, every, driven.known_after_s)
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


def run_of(bound: BoundPlant, log: RunLog, name: str, window_s: float, every: int = 1) -> Run:
    """A log as a run; axes that it says were locked stand still at the median of their readings."""
    if not log.locked:
        return log_run(bound, log, name, window_s, every)
    positions = {str(axis.position): axis.name for axis in bound.model.axes if axis.name in log.locked}
    held = {
        positions[str(state)]: float(np.nan_to_num(np.nanmedian(log.column(output))))
        for output, state in bound.model.outputs.items()
        if str(state) in positions
    }
    part = subsystem(bound, locked_model(bound.model, held))
    kept = [place for place, output in enumerate(bound.model.outputs) if output in part.model.outputs]
    return log_run(part, replace(log, columns=log_columns(part.model), y=log.y[:, kept]), name, window_s, every)


def _check(bound: BoundPlant, log: RunLog, name: str) -> None:
    if log.t_s.size < 2:
        raise BadInput("log", name, f"{log.t_s.size} row", "at least two rows", "give a longer log")
    if not np.any(np.isfinite(log.y)):
        got = f"no number of {', '.join(log.columns.outputs)} in {log.t_s.size} rows"
        raise BadInput(
            "readings", name, got, "a reading of at least one output", "give a log in which something was measured"
        )
    demand_equations_alone(bound)


def demand_equations_alone(bound: BoundPlant) -> None:
    """Raise BadInput for a plant with effects on the way of its inputs or outputs."""
    if bound.input_path or bound.output_path:
        got, remedy = "effects on the way of an input or output", "identify from the plant without them"
        raise BadInput("effects", bound.plant.name, got, "effects in the equations alone", remedy)


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


def _windows(log: RunLog, window_s: float, every: int, from_s: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First rows of windows of `window_s` and less, and the rows behind their last; `from_s` at the beginning is left out."""
    t_s = log.t_s
    first_s = t_s[0] + from_s
    count = max(1, round((t_s[-1] - first_s) / window_s)) if np.isfinite(window_s) else 1
    edges = first_s + (t_s[-1] - first_s) * np.arange(count) / count
    even = np.searchsorted(t_s, edges - 1e-9)
    anew = np.concatenate([behind_missing_rows(log), read_again(log)])
    begins = np.union1d(even, anew[anew > even[0]]).astype(np.int64)
    stops = np.append(begins[1:], t_s.size).astype(np.int64)
    return begins[::every], stops[::every]
