"""A start for the fit from anywhere within the bounds, by a method of the table; others may be run beside it for comparison."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.normal_equations import Point
from identification.fit.problem import Problem, Tell, Told, by_name
from identification.fit.solve import solve
from identification.search.evolution import evolution
from identification.search.genetic import Code, evolve
from identification.search.population import absolute_error

Array = NDArray[np.float64]
DRAWN = 50  # points, as many as a population of seed 001
UNBOUNDED = 5.0  # sizes
BITS = 20  # of a parameter whose length nobody states: one step is a millionth of its range


Progress = Callable[[int, int], None]


def unheard(done: int, of: int) -> None:
    """Progress that nobody wants to hear of."""


@dataclass(frozen=True)
class Search:
    """What is asked for: a method of `METHODS`, its seed, the code lengths of parameters by name (for `genetic`), methods to run beside.

    `progress` hears after each generation which one that was, and of how many.
    """

    method: str
    seed: int = 1
    bits: Mapping[str, int] = field(default_factory=dict)
    beside: tuple[str, ...] = ()
    progress: Progress = unheard


@dataclass(frozen=True, eq=False)
class Searched:
    """What a method found for the parameters `names` between lower and upper: values, all (parameters,), their J = sum |e|, CPU seconds.

    `best` and `mean` are what the method itself counts, generation by generation; `bits` are empty where nothing is coded.
    """

    method: str
    names: tuple[str, ...]
    lower: Array
    upper: Array
    values: Array
    error: float
    cpu_s: float
    best: tuple[float, ...]
    mean: tuple[float, ...]
    bits: tuple[int, ...] = ()


def search(problem: Problem, places: list[int], wanted: Search, told: Told | None = None) -> tuple[Searched, ...]:
    """The wanted method's result for the parameters at `places`, the others held, and those of the methods beside it.

    `told` hears of better parameters whenever the wanted method finds them. A parameter without bounds is looked for within some sizes
    of its start. The same seed gives the same values.
    """
    reach = UNBOUNDED * problem.scale
    lower, upper = np.maximum(problem.lower, problem.start - reach), np.minimum(problem.upper, problem.start + reach)
    finite = replace(
        problem,
        lower=np.where(np.isfinite(problem.lower), problem.lower, lower),
        upper=np.where(np.isfinite(problem.upper), problem.upper, upper),
    )
    tell = by_name([problem.names[place] for place in places], told)
    return (
        _one(finite, places, wanted, wanted.method, tell),
        *(_one(finite, places, wanted, method, by_name((), None)) for method in wanted.beside),
    )


def started(problem: Problem, places: list[int], found: Searched) -> Problem:
    """The problem that starts from what was found."""
    return replace(problem, start=_with(problem, places, found.values))


def _one(problem: Problem, places: list[int], wanted: Search, method: str, tell: Tell) -> Searched:
    begin = time.process_time()
    theta, best, mean, bits = METHODS[method](problem, places, wanted, tell)
    took_s = time.process_time() - begin
    return Searched(
        method=method,
        names=tuple(problem.names[place] for place in places),
        lower=problem.lower[places],
        upper=problem.upper[places],
        values=theta[places],
        error=float(absolute_error(problem, theta[None])[0]),
        cpu_s=took_s,
        best=best,
        mean=mean,
        bits=bits,
    )


# All of theta, what is best and what is the mean by generation, bits.
Trail = tuple[Array, tuple[float, ...], tuple[float, ...], tuple[int, ...]]


def _evolution(problem: Problem, places: list[int], wanted: Search, tell: Tell) -> Trail:
    values, best = evolution(problem, places, wanted.seed, tell, wanted.progress)
    return _with(problem, places, values), best, (), ()


def _genetic(problem: Problem, places: list[int], wanted: Search, tell: Tell) -> Trail:
    """The algorithm of seed 001, whole populations in one call of the kernel."""
    names = [problem.names[place] for place in places]
    code = Code(problem.lower[places], problem.upper[places], tuple(wanted.bits.get(name, BITS) for name in names))

    def cost(members: Array) -> Array:
        return absolute_error(problem, np.stack([_with(problem, places, values) for values in members]))

    found = evolve(code, cost, wanted.seed, watch=tell, progress=wanted.progress)
    return _with(problem, places, found.values), found.best, found.mean, code.bits


def _gradient(problem: Problem, places: list[int], wanted: Search, tell: Tell) -> Trail:
    """The compiled least squares from the best of some points drawn within the range: no more is known to it than to the others.

    From the middle alone it may find no way: an arm that does not lift off has no slopes.
    """
    lower, upper = problem.lower[places], problem.upper[places]
    drawn = np.random.default_rng(wanted.seed).uniform(lower, upper, (DRAWN, len(places)))
    points = np.stack([_with(problem, places, values) for values in drawn])
    start = points[int(np.argmin(absolute_error(problem, points)))]
    costs: list[float] = []
    blind = replace(problem, start=start, prior=replace(problem.prior, mean=start))

    def watch(point: Point) -> None:
        costs.append(point.cost)
        tell(point.theta[places])

    return solve(blind, watch).theta, tuple(costs), (), ()


def _with(problem: Problem, places: list[int], values: Array) -> Array:
    theta = problem.start.copy()
    theta[places] = values
    return theta


METHODS: Mapping[str, Callable[[Problem, list[int], Search, Tell], Trail]] = {
    "evolution": _evolution,
    "genetic": _genetic,
    "gradient": _gradient,
}
