"""A plant from run logs: short windows find the way from a bad start; then the whole logs, or windows where the model lacks something."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.fit.belief import NOTHING, Belief, widened
from identification.fit.ranges import Range, ranges_of
from identification.fit.solve import Point, Prior, Problem, Told, by_name, solve
from identification.fit.steps import followed
from identification.model.locked import locked_model
from identification.model.subsystem import subsystem
from identification.runs.log_run import log_run
from identification.runs.run import Run, coefficient_names, offset_names
from identification.search.methods import Search, search, started
from identification.stages.estimate import CONTRADICTION_SD, Estimate, estimate, problem_of
from identification.stages.sizes import with_sizes
from identification.uncertainty.residuals import ResidualTest, residual_tests
from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import log_columns

Array = NDArray[np.float64]
COARSE_S = 0.5
COARSE_WINDOWS = 40  # of each log: enough for a start
COARSE_SETTLED = 10.0
HOLDOUT_S = 1.0
WORSE, MOST_LEFT = 1.5, 0.3
SENSORS = 1.1  # times what a sensor alone leaves: as good as that
NEARLY = 2.0  # times that from a fit that has not settled
WINDOW_ROWS = (40, 160, 640)


def fits_of_logs(
    bound: BoundPlant,
    logs: Mapping[str, RunLog],
    names: Sequence[str],
    *,
    window_s: float | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    before: Belief = NOTHING,
    wanted: Search | None = None,
    offsets: bool = False,
    told: Told | None = None,
) -> Iterator[Estimate]:
    """The coefficients `names` from all logs at once, by output errors over windows of `window_s` (inf: each log whole).

    What shows only in an output that no log has a reading of is to be left out (`identification.model.shown`): it would be read off a
    guess. By default each log whole, where that leaves no more than the sensors do; else one fit after the other over longer and longer
    windows, of which `best_fit` chooses. `wanted` asks for a search over the whole range first; `offsets` adds a constant to each input,
    the trim of a real rig, to what is estimated; `told` hears of better parameters as soon as there are any. Raises BadInput for an
    unknown coefficient or a start outside its limits.
    """
    coarse = _short_windows(bound, logs)
    ranges = _ranges(bound, logs, coarse, (*before.names, *names), limits or {}, offsets)
    names = (*names, *(offset_names(bound.model) if offsets else ()))
    first = _coarse(coarse, names, ranges, before, wanted, told)
    reached = dict(zip(widened(before, names, {})[0], first.theta.tolist(), strict=True))
    start = {name: reached[name] for name in names}

    def fitted(length_s: float, start: Mapping[str, float]) -> Estimate:
        closer = ranges | {name: replace(ranges[name], start=value) for name, value in start.items()}
        runs = [
            replace(run_of(bound, log, name, length_s), substeps=short.substeps)
            for short, (name, log) in zip(coarse, logs.items(), strict=True)
        ]
        held = _held(tuple(runs), *widened(before, names, start))
        return estimate(held.runs, names, closer, before, told)

    if window_s is not None:
        yield fitted(window_s, start)
        return
    if _may_explain(first) and _nothing_left(whole := fitted(np.inf, start)):
        yield whole
        return
    period_s = max(float(np.median(np.diff(log.t_s))) for log in logs.values())
    for rows in WINDOW_ROWS:
        found = fitted(period_s * rows, start)
        start = {name: found.belief.value(name) for name in names}
        yield found


def identify_logs(bound: BoundPlant, logs: Mapping[str, RunLog], names: Sequence[str], **wishes: Any) -> Estimate:
    """The best of `fits_of_logs`, which see for the wishes."""
    return best_fit(list(fits_of_logs(bound, logs, names, **wishes)))


def _ranges(
    bound: BoundPlant,
    logs: Mapping[str, RunLog],
    coarse: Sequence[Run],
    names: Sequence[str],
    limits: Mapping[str, tuple[float, float]],
    offsets: bool,
) -> dict[str, Range]:
    """Where each parameter may lie; one of value and sd 0 gets its size from what it would do to these logs."""
    ranges = ranges_of(bound, tuple(dict.fromkeys(names)), limits)
    places = {name: place for place, name in enumerate(coefficient_names(bound.model))}
    absent = [
        name for name in ranges if not bound.p[places[name]] and not bound.sd[places[name]] and name not in limits
    ]
    if offsets:
        ranges |= _offset_ranges(bound, logs)
    return with_sizes(coarse, ranges, absent)


def best_fit(found: Sequence[Estimate]) -> Estimate:
    """Of fits over shorter and longer windows the one that leaves the least volume open.

    Over long windows a fit may have caught a wrong phase, or nothing at all, or what the model lacks has grown into its parameters: one
    that predicts the shortest windows clearly worse than the best does not count, nor one that leaves more than `MOST_LEFT` of what its
    own readings do, nor one that contradicts the shortest windows by more than both intervals allow.
    """
    if len(found) == 1:
        return found[0]
    costs = [_held(found[0].runs, entry.belief.names, entry.belief.mean).cost for entry in found]
    sound = [
        entry
        for entry, cost in zip(found, costs, strict=True)
        if cost <= WORSE**2 * min(costs)
        and all(test.fit > 1.0 - MOST_LEFT or _of_the_sensor(test) for test in entry.residuals)
        and apart_sd(found[0].belief, entry.belief) <= CONTRADICTION_SD
    ]
    return min(sound or found[:1], key=_volume)


def _may_explain(first: Point) -> bool:
    """The model explains short windows, if not to the last bit yet; where it does not, a whole log is not worth a fit."""
    fitted = zip(first.runs, first.blocks, strict=True)
    tests = (test for run, blocks in fitted for test in residual_tests(run, blocks))
    return all(test.rms <= NEARLY * test.floor for test in tests)


def _nothing_left(whole: Estimate) -> bool:
    """The model and one start of each log explain all readings: what is left is white, and no more than the sensors' own errors."""
    return all(test.white and _of_the_sensor(test) for test in whole.residuals)


def _of_the_sensor(test: ResidualTest) -> bool:
    """No more is left than the sensor's own errors: so it is of an axis at rest, too, none of whose readings are explained."""
    return test.rms <= SENSORS * test.floor


def apart_sd(one: Belief, other: Belief) -> float:
    """The largest difference of a parameter between two estimates of the same names, in standard deviations of both together."""
    return float(np.max(np.abs(one.mean - other.mean) / np.hypot(one.sd, other.sd), initial=0.0))


def _held(runs: tuple[Run, ...], names: tuple[str, ...], theta: Array) -> Point:
    """Criterion (10) over these runs with the parameters held and the windows' starts fitted.

    A fit begins from these starts: over long windows guessed ones are so far off that parameters which follow them lose their way.
    """
    free = Prior(theta, np.zeros((theta.size, theta.size)))
    return solve(Problem(names, theta, np.abs(theta) + 1e-12, theta, theta, runs, free))


def _volume(found: Estimate) -> float:
    """The logarithm of the volume that the estimate leaves open."""
    part = found.belief.part(found.own)
    return float(np.linalg.slogdet(part.correlation)[1] / 2.0 + np.sum(np.log(part.sd)))


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


def _offset_ranges(bound: BoundPlant, logs: Mapping[str, RunLog]) -> dict[str, Range]:
    """An input's offset lies within so much as the input itself moves."""
    spread = np.maximum(np.max([np.std(log.u, axis=0) for log in logs.values()], axis=0), 1e-9)
    return {
        name: Range(0.0, -5.0 * float(size), 5.0 * float(size), float(size))
        for name, size in zip(offset_names(bound.model), spread, strict=True)
    }


def trimmed(log: RunLog, begin_s: float, end_s: float) -> RunLog:
    """The rows of a log from `begin_s` to `end_s`; raises BadInput where fewer than two are left."""
    kept = (log.t_s >= begin_s) & (log.t_s <= end_s)
    if kept.sum() < 2:
        whole = f"{log.t_s[0]:g} s to {log.t_s[-1]:g} s"
        raise BadInput(
            "log", "trimming", f"no rows from {begin_s:g} s to {end_s:g} s", f"a part of {whole}", "choose other times"
        )
    extra = {name: values[kept] for name, values in log.extra.items()}
    seq = None if log.seq is None else log.seq[kept]
    return replace(log, t_s=log.t_s[kept], u=log.u[kept], y=log.y[kept], extra=extra, seq=seq)


def without_readings(log: RunLog, rows: NDArray[np.bool_]) -> RunLog:
    """The log with nothing measured in these of its rows (n,); their times and inputs stand."""
    return replace(log, y=np.where(rows[:, None], np.nan, log.y)) if np.any(rows) else log


def prediction_tests(
    bound: BoundPlant, logs: Mapping[str, RunLog], offsets: Mapping[str, float] | None = None
) -> tuple[ResidualTest, ...]:
    """How the plant as it is predicts logs that were not used: free-running over windows of a second, whose starts alone are fitted.

    `offsets` are constants added to its inputs, by "offset.INPUT".
    """
    added = np.array([(offsets or {}).get(name, 0.0) for name in offset_names(bound.model)])
    shifted = {name: replace(log, u=log.u + added) for name, log in logs.items()}
    runs = tuple(followed(run_of(bound, log, name, HOLDOUT_S)) for name, log in shifted.items())
    point = solve(problem_of(runs, (), {}, NOTHING))
    return tuple(test for run, own in zip(point.runs, point.blocks, strict=True) for test in residual_tests(run, own))


def _short_windows(bound: BoundPlant, logs: Mapping[str, RunLog]) -> tuple[Run, ...]:
    """Short windows spread over each log."""
    counts = {name: (log.t_s[-1] - log.t_s[0]) / COARSE_S for name, log in logs.items()}
    return tuple(
        followed(run_of(bound, log, name, COARSE_S, max(1, int(counts[name] // COARSE_WINDOWS))))
        for name, log in logs.items()
    )


def _coarse(
    runs: tuple[Run, ...],
    names: Sequence[str],
    ranges: Mapping[str, Range],
    before: Belief,
    wanted: Search | None,
    told: Told | None,
) -> Point:
    """A start for the fine fit."""
    problem = problem_of(runs, tuple(names), ranges, before)
    if wanted is not None:
        places = [problem.names.index(name) for name in names]
        problem = started(problem, places, search(problem, places, replace(wanted, beside=()), told)[0])
    tell = by_name(problem.names, told)
    return solve(problem, lambda better: tell(better.theta), COARSE_SETTLED)
