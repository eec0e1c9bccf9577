"""A plant from run logs: short windows first, which find the way from a bad start, then long ones, which hold the parameters tightly."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from identification.belief import NOTHING, Belief
from identification.estimate import Estimate, Range, estimate, problem_of
from identification.locked import locked_model
from identification.log_run import log_run
from identification.ranges import ranges_of
from identification.run import Run, coefficient_names
from identification.search import search
from identification.sizes import with_sizes
from identification.solve import solve
from identification.subsystem import subsystem
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import log_columns

COARSE_S = 0.5
COARSE_WINDOWS = 40  # of each log: enough for a start
COARSE_SETTLED = 10.0
WINDOW_ROWS = (40, 160, 640)
Watch = Callable[[int, float], None]


def identify_logs(
    bound: BoundPlant,
    logs: Mapping[str, RunLog],
    names: Sequence[str],
    *,
    window_s: float | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    before: Belief = NOTHING,
    search_seed: int | None = None,
    watch: Watch | None = None,
) -> Estimate:
    """The coefficients `names` from all logs at once, by output errors over windows of `window_s` (inf: each log whole).

    By default several lengths are tried and the one that leaves the smallest uncertainty is kept: short ones where disturbances grow
    into the prediction or the plant is unstable, long ones where the model holds. `search_seed` asks for a search over the whole range
    first. Raises BadInput for an unknown coefficient or a start outside its limits.
    """
    every = tuple(dict.fromkeys((*before.names, *names)))
    ranges = ranges_of(bound, every, limits)
    coarse = _short_windows(bound, logs)
    known = coefficient_names(bound.model)
    absent = [name for name in names if not bound.p[known.index(name)] and not bound.sd[known.index(name)]]
    ranges = with_sizes(coarse, ranges, [name for name in absent if name not in (limits or {})])
    start = _coarse(coarse, names, ranges, before, search_seed, watch)
    closer = {name: replace(ranges[name], start=value) for name, value in start.items()}
    period_s = max(float(np.median(np.diff(log.t_s))) for log in logs.values())
    lengths = [period_s * rows for rows in WINDOW_ROWS] if window_s is None else [window_s]
    found = [
        estimate(
            [run_of(bound, log, name, length) for name, log in logs.items()], names, ranges | closer, before, watch
        )
        for length in lengths
    ]
    return min(found, key=_volume)


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


def _short_windows(bound: BoundPlant, logs: Mapping[str, RunLog]) -> tuple[Run, ...]:
    """Short windows spread over each log."""
    counts = {name: (log.t_s[-1] - log.t_s[0]) / COARSE_S for name, log in logs.items()}
    return tuple(
        run_of(bound, log, name, COARSE_S, max(1, int(counts[name] // COARSE_WINDOWS))) for name, log in logs.items()
    )


def _coarse(
    runs: tuple[Run, ...],
    names: Sequence[str],
    ranges: Mapping[str, Range],
    before: Belief,
    search_seed: int | None,
    watch: Watch | None,
) -> dict[str, float]:
    """A start for the fine fit."""
    problem = problem_of(runs, tuple(names), ranges, before)
    if search_seed is not None:
        problem = search(problem, [problem.names.index(name) for name in names], search_seed)
    point = solve(problem, watch, COARSE_SETTLED)
    found = dict(zip(problem.names, point.theta.tolist(), strict=True))
    return {name: found[name] for name in names}
