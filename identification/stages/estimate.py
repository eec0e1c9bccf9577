"""One stage of identification: fit, weigh the readings by what they turn out to be worth, state how far the result may be off."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from identification.fit.belief import Belief, prior, widened
from identification.fit.information import inverse, marginal
from identification.fit.normal_equations import ROUNDING, Point, at, growth
from identification.fit.problem import Prior, Problem, Told, by_name
from identification.fit.ranges import Range
from identification.fit.solve import Watch, leapt, solve
from identification.fit.steps import MOST_PER_SAMPLE, SHIFT_SD, finer, in_steps_of, shift_sd
from identification.runs.run import Run
from identification.search.methods import Search, Searched, search, started
from identification.stages.weights import by_channel, by_correlation
from identification.uncertainty.contradiction import Contradiction, contradictions
from identification.uncertainty.correlation import pieces
from identification.uncertainty.discord import Discord, discords
from identification.uncertainty.identifiability import Direction, unseen
from identification.uncertainty.residuals import ResidualTest, tests_at
from records.errors import BadInput

Array = NDArray[np.float64]
LOOSER = 10.0  # than a parameter's size: what the data tell is no less certain for it


@dataclass(frozen=True)
class Data:
    """What a fit was made from: its `title`, and how a cell of a table calls it; the `kind` of an experiment, or the names of `logs`."""

    title: str
    short: str
    kind: str = ""
    logs: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.title


@dataclass(frozen=True, eq=False)
class Estimate:
    """The result of a stage: belief over all parameters so far, those it was about, degrees of freedom of the intervals, and tests.

    `at_bound` names parameters that ended at a bound of their range: the data pull them further, and their intervals mean little.
    `discords` name those in which runs that were fitted together contradict one another. `start` is where the fit began, by name,
    `growth` how far slopes grew within a window, and `loose_sd` the sd of each had those of `own` been held `LOOSER` times as loosely.
    Of those `fresh` nothing was known before but a size. `problem` is the last one that was solved, its readings weighted.
    """

    belief: Belief
    own: tuple[str, ...]
    dof: float
    cost: float
    steps: int
    unseen: tuple[Direction, ...]
    contradictions: tuple[Contradiction, ...]
    at_bound: tuple[str, ...]
    residuals: tuple[ResidualTest, ...]
    runs: tuple[Run, ...]
    start: Mapping[str, float]
    problem: Problem
    fresh: tuple[str, ...]
    searched: tuple[Searched, ...] = ()
    discords: tuple[Discord, ...] = ()
    growth: float = 1.0
    loose_sd: Mapping[str, float] = field(default_factory=dict)


def interval_factor(dof: float) -> float:
    """Half the width of a 95 % interval in standard deviations, by Student's distribution."""
    return float(stdtrit(max(dof, 1.0), 0.975))


def interval_factors(stages: Iterable[Estimate]) -> dict[str, float]:
    """The same for each parameter, by the degrees of freedom of the first stage about it."""
    factors: dict[str, float] = {}
    for stage in stages:
        for name in stage.own:
            factors.setdefault(name, interval_factor(stage.dof))
    return factors


def estimate(
    runs: Sequence[Run],
    own: Sequence[str],
    ranges: Mapping[str, Range],
    before: Belief,
    told: Told | None = None,
    wanted: Search | None = None,
) -> Estimate:
    """Fit the parameters `own` to the runs, with those of `before` re-estimated from what is known of them.

    Earlier stages enter as a normal distribution, so the joint covariance carries their uncertainty on; after the last stage it is that
    of one fit to all runs, to first order. Channels are weighted by their own residuals, Q_V = diag(1 / rms^2), and a run whose
    residuals are correlated counts for fewer samples. `wanted` asks for a search over the whole range of `own` first; `told` hears of
    better parameters as soon as there are any.
    """
    problem = problem_of(tuple(runs), tuple(own), ranges, before)
    problem, searched = searched_for(problem, own, wanted, told)
    start = starts_of(problem)
    tell = by_name(problem.names, told)
    problem, point = _fitted(problem, len(before.names), lambda better: tell(better.theta))
    return _estimate(problem, point, tuple(own), before, start, searched)


def starts_of(problem: Problem) -> dict[str, float]:
    """Where a fit of the problem begins, by name."""
    return dict(zip(problem.names, problem.start.tolist(), strict=True))


def searched_for(
    problem: Problem, own: Sequence[str], wanted: Search | None, told: Told | None
) -> tuple[Problem, tuple[Searched, ...]]:
    """The problem from the start that a search found, where one is wanted, and what was found."""
    if wanted is None:
        return problem, ()
    places = [problem.names.index(name) for name in own]
    found = search(problem, places, wanted, told)
    return started(problem, places, found[0]), found


def _estimate(
    problem: Problem,
    point: Point,
    own: tuple[str, ...],
    before: Belief,
    start: Mapping[str, float],
    searched: tuple[Searched, ...],
) -> Estimate:
    """What the optimum tells."""
    after = Belief(problem.names, point.theta, inverse(point.H + problem.prior.information))
    return Estimate(
        belief=after,
        own=own,
        dof=max(1.0, float(pieces(point) - len(own))),
        cost=point.cost,
        steps=point.steps,
        unseen=_unseen(problem, point, own, before),
        contradictions=contradictions(before, after),
        at_bound=_at_bound(problem, point),
        residuals=tests_at(point),
        runs=point.runs,
        start=start,
        problem=problem,
        fresh=tuple(name for name in problem.names if name not in before.names),
        searched=searched,
        discords=discords(problem, point),
        growth=growth(point),
        loose_sd=_loose_sd(problem, point, before),
    )


def counting(fit: Estimate, known: Belief) -> Estimate:
    """The fit made again with what is `known` of some of its parameters as one more reading: V + |theta - known|^2 over its covariance.

    What merely gave these a size falls away. What the data alone say of contradictions, directions and degrees of freedom stays as it is.
    """
    problem = fit.problem
    places = [problem.names.index(name) for name in known.names]
    both, mean = problem.prior.information.copy(), problem.prior.mean
    fresh = [place for place in places if problem.names[place] in fit.fresh]
    both[fresh, fresh] -= 1.0 / problem.scale[fresh] ** 2
    firm = inverse(known.covariance)
    both[np.ix_(places, places)] += firm
    # Two normal distributions make one: the sum of both informations, about the mean that both draw to.
    pull = np.zeros(mean.size)
    pull[places] = firm @ (known.mean - mean[places])
    centre = mean + inverse(both) @ pull
    problem = leapt(replace(problem, start=fit.belief.mean, runs=fit.runs, prior=Prior(centre, both)))
    point = solve(problem)
    return replace(
        fit,
        belief=Belief(problem.names, point.theta, inverse(point.H + both)),
        cost=point.cost,
        steps=fit.steps + point.steps,
        at_bound=_at_bound(problem, point),
        residuals=tests_at(point),
        runs=point.runs,
        problem=problem,
        growth=growth(point),
    )


def _loose_sd(problem: Problem, point: Point, before: Belief) -> dict[str, float]:
    """The sd by name with the weak prior `LOOSER` times as wide: of a direction that many share each holds so little that it looks told."""
    # By eigenvectors: beside what data tell well of one direction a matrix has no digits left for what they do not of another.
    values, vectors = np.linalg.eigh(_known(problem, point, before) * np.outer(problem.scale, problem.scale))
    sd = problem.scale * np.sqrt(vectors**2 @ (1.0 / (np.maximum(values, 0.0) + LOOSER**-2)))
    return dict(zip(problem.names, sd.tolist(), strict=True))


def _unseen(problem: Problem, point: Point, own: tuple[str, ...], before: Belief) -> tuple[Direction, ...]:
    """Directions of `own` that neither the data nor what was known before tell."""
    places = [problem.names.index(name) for name in own]
    known = marginal(_known(problem, point, before), places, problem.scale)
    return unseen(own, known, problem.scale[places])


def _known(problem: Problem, point: Point, before: Belief) -> Array:
    """The information of data and of what was known before, less what only gives a size."""
    # What rounding was given stands for no reading: no direction is known by it.
    rounding = 2.0 * ROUNDING * np.diag(np.diag(point.JtJ))
    return np.asarray(point.H - rounding + problem.prior.information - np.diag(_weak(problem, before)))


def _at_bound(problem: Problem, point: Point) -> tuple[str, ...]:
    bounds = zip(problem.names, point.theta, problem.lower, problem.upper, strict=True)
    return tuple(name for name, value, lower, upper in bounds if value in (lower, upper))


def _fitted(problem: Problem, known: int, watch: Watch) -> tuple[Problem, Point]:
    """Fit, weigh, fit again; the same in half the steps while those move the estimates, and less each time."""
    problem, before = _within_numbers(problem), np.inf
    while True:
        weighed, point = _weighed_fit(problem, known, watch)
        now = shift_sd(weighed, point)
        if now <= SHIFT_SD or now > before / 2.0 or max(run.substeps for run in point.runs) >= MOST_PER_SAMPLE:
            return weighed, point
        problem, before = replace(problem, start=point.theta, runs=finer(problem.runs, point)), now


def _within_numbers(problem: Problem) -> Problem:
    """The problem in as many steps a sample as its start needs, which may be of a faster plant than the one that is stated."""
    if np.isfinite(at(problem, problem.start, problem.runs).cost):
        return problem
    return replace(problem, runs=tuple(in_steps_of(run, problem.names, problem.start) for run in problem.runs))


def _weighed_fit(problem: Problem, known: int, watch: Watch) -> tuple[Problem, Point]:
    """Fit, weigh by channel, fit, weigh by correlation, fit; the first `known` parameters are held by what is known of them."""
    point = solve(problem, watch)
    for weigh in (by_channel, by_correlation):
        problem = _recentred(replace(problem, start=point.theta, runs=weigh(problem, point)), known)
        point = solve(problem, watch)
        _demand_motion(problem, point)
    return problem, point


def _demand_motion(problem: Problem, point: Point) -> None:
    """Raises BadInput where the runs cannot be followed from any start that the fit had."""
    if np.isfinite(point.cost):
        return
    values = ", ".join(f"{name} = {value:.4g}" for name, value in zip(problem.names, point.theta, strict=True))
    raise BadInput(
        "start of a fit",
        ", ".join(run.name for run in point.runs),
        f"a motion that leaves the range of numbers, with {values}",
        "one that the runs can be compared with",
        "give the plant file values nearer to the rig, or cut logs into shorter windows with --window",
    )


def problem_of(runs: tuple[Run, ...], own: tuple[str, ...], ranges: Mapping[str, Range], before: Belief) -> Problem:
    """The problem of fitting `own` with what is known before; those of `before` start at their means."""
    names, theta = widened(before, own, {name: entry.start for name, entry in ranges.items()})
    scale = np.array([ranges[name].scale for name in names])
    return Problem(
        names=names,
        start=theta,
        scale=scale,
        lower=np.array([ranges[name].lower for name in names]),
        upper=np.array([ranges[name].upper for name in names]),
        runs=runs,
        prior=prior(before, theta, scale),
    )


def _weak(problem: Problem, before: Belief) -> Array:
    """The diagonal of the prior that stands for no knowledge."""
    weak = 1.0 / problem.scale**2
    weak[: len(before.names)] = 0.0
    return np.asarray(weak)


def _recentred(problem: Problem, known: int) -> Problem:
    """What merely gives a new parameter a size holds it where it is by now: weights that fell must not let it pull back to a far start."""
    mean = np.concatenate([problem.prior.mean[:known], problem.start[known:]])
    return replace(problem, prior=replace(problem.prior, mean=mean))
