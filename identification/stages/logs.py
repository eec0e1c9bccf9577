"""A plant from run logs: short windows find the way from a bad start; then the whole logs, or windows where the model lacks something."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.belief import NOTHING, Belief, widened
from identification.fit.normal_equations import Point
from identification.fit.problem import Told, by_name
from identification.fit.ranges import Range
from identification.fit.solve import solve
from identification.fit.steps import followed
from identification.runs.log_run import run_of
from identification.runs.run import Run, offset_names
from identification.search.methods import Search, Searched
from identification.stages.best_fit import best_fit, may_explain, nothing_left, with_best_starts
from identification.stages.estimate import Estimate, estimate, problem_of, searched_for, starts_of
from identification.stages.sizes import ranges_of_logs
from records.log import RunLog
from sim.bind import BoundPlant

Array = NDArray[np.float64]
# In the plant's own seconds (Model.second_s): within half a second an oven moves by less than a step of its probe, and a start from that
# leads a fit astray.
COARSE_S = 0.5
COARSE_WINDOWS = 40  # of each log: enough for a start
COARSE_SETTLED = 10.0
WINDOW_ROWS = (40, 160, 640)


@dataclass(frozen=True)
class Asked:
    """What is asked of a fit of logs: windows of `window_s` (inf: each log whole; None: as the logs need), coefficients' `limits`, what is
    known `before`, a search over the whole range first (`wanted`), `offsets`, a constant on each input, the trim of a real rig, to be
    estimated too, and who is `told` of better parameters as soon as there are any."""

    window_s: float | None = None
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    before: Belief = NOTHING
    wanted: Search | None = None
    offsets: bool = False
    told: Told | None = None


NOTHING_MORE = Asked()


def fits_of_logs(
    bound: BoundPlant, logs: Mapping[str, RunLog], names: Sequence[str], asked: Asked = NOTHING_MORE
) -> Iterator[Estimate]:
    """The coefficients `names` from all logs at once, by output errors over windows.

    What shows only in an output that no log has a reading of is to be left out (`identification.model.shown`): it would be read off a
    guess. By default each log whole, where that leaves no more than the sensors do; else one fit after the other over longer and longer
    windows, of which `best_fit` chooses. Raises BadInput for an unknown coefficient or a start outside its limits.
    """
    coarse = _short_windows(bound, logs)
    ranges = ranges_of_logs(bound, logs, coarse, (*asked.before.names, *names), asked.limits, asked.offsets)
    names = (*names, *(offset_names(bound.model) if asked.offsets else ()))
    first, begun, searched = _coarse(coarse, names, ranges, asked)
    reached = dict(zip(widened(asked.before, names, {})[0], first.theta.tolist(), strict=True))
    start = {name: reached[name] for name in names}

    def fitted(length_s: float, start: Mapping[str, float]) -> Estimate:
        """The coefficients of `start` by windows of `length_s`, in as many steps a sample as the short ones needed."""
        closer = ranges | {name: replace(ranges[name], start=value) for name, value in start.items()}
        runs = tuple(
            replace(run_of(bound, log, name, length_s), substeps=short.substeps)
            for short, (name, log) in zip(coarse, logs.items(), strict=True)
        )
        held = with_best_starts(runs, *widened(asked.before, tuple(start), start))
        found = estimate(held.runs, tuple(start), closer, asked.before, asked.told)
        return replace(found, start=begun, searched=searched)

    if asked.window_s is not None:
        yield fitted(asked.window_s, start)
        return
    if may_explain(first) and nothing_left(whole := fitted(np.inf, start)):
        yield whole
        return
    period_s = max(float(np.median(np.diff(log.t_s))) for log in logs.values())
    for rows in WINDOW_ROWS:
        found = fitted(period_s * rows, start)
        start = {name: found.belief.value(name) for name in names}
        yield found


def identify_logs(
    bound: BoundPlant, logs: Mapping[str, RunLog], names: Sequence[str], asked: Asked = NOTHING_MORE
) -> Estimate:
    """The best of `fits_of_logs`."""
    return best_fit(list(fits_of_logs(bound, logs, names, asked)))


def _short_windows(bound: BoundPlant, logs: Mapping[str, RunLog]) -> tuple[Run, ...]:
    """Short windows spread over each log."""
    coarse_s = COARSE_S * bound.model.second_s
    counts = {name: (log.t_s[-1] - log.t_s[0]) / coarse_s for name, log in logs.items()}
    return tuple(
        followed(run_of(bound, log, name, coarse_s, max(1, int(counts[name] // COARSE_WINDOWS))))
        for name, log in logs.items()
    )


def _coarse(
    runs: tuple[Run, ...],
    names: Sequence[str],
    ranges: Mapping[str, Range],
    asked: Asked,
) -> tuple[Point, Mapping[str, float], tuple[Searched, ...]]:
    """A start for the fine fit, where it began itself, and what was searched for that."""
    problem, searched = searched_for(
        problem_of(runs, tuple(names), ranges, asked.before), names, asked.wanted, asked.told
    )
    tell = by_name(problem.names, asked.told)
    return solve(problem, lambda better: tell(better.theta), COARSE_SETTLED), starts_of(problem), searched
