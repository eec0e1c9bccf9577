"""Of fits over shorter and longer windows the one to keep: what a model explains decides how long its windows may be."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from identification import thresholds
from identification.fit.belief import Belief
from identification.fit.normal_equations import ROUNDING, Point
from identification.fit.problem import Prior, Problem
from identification.fit.solve import solve
from identification.runs.run import Run
from identification.stages.estimate import Estimate
from identification.uncertainty.residuals import ResidualTest, tests_at

Array = NDArray[np.float64]
ROUNDED_OFF = 1e-12  # of an estimate, below which runs in double precision, in steps, tell nothing
MOST_GROWTH = ROUNDING**-0.5  # of a window's slopes: beyond it the rounding of their squares outweighs a first reading


def best_fit(found: Sequence[Estimate]) -> Estimate:
    """Of fits over shorter and longer windows the one that leaves the least volume open.

    Over long windows a fit may have caught a wrong phase, or nothing at all, or what the model lacks has grown into its parameters: one
    that predicts the shortest windows clearly worse than the best does not count, nor one that leaves more than `MOST_LEFT` of what its
    own readings do, nor one that contradicts the shortest windows by more than both intervals allow, nor one within whose windows an
    unstable plant has carried the slopes past all digits.
    """
    if len(found) == 1:
        return found[0]
    costs = [with_best_starts(found[0].runs, entry.belief.names, entry.belief.mean).cost for entry in found]
    sound = [
        entry
        for entry, cost in zip(found, costs, strict=True)
        if cost <= thresholds.WORSE**2 * min(costs)
        and entry.growth <= MOST_GROWTH
        and all(test.fit > 1.0 - thresholds.MOST_LEFT or _of_the_sensor(test) for test in entry.residuals)
        and apart_sd(found[0].belief, entry.belief) <= thresholds.CONTRADICTS
    ]
    return min(sound or found[:1], key=_volume)


def may_explain(first: Point) -> bool:
    """The model explains short windows, if not to the last bit yet; where it does not, a whole log is not worth a fit."""
    return all(test.rms <= thresholds.NEARLY * test.floor for test in tests_at(first))


def nothing_left(whole: Estimate) -> bool:
    """The model and one start of each log explain all readings: what is left is white, and no more than the sensors' own errors.

    Of an unstable plant that is no proof: slopes that have grown past all digits claim what no arithmetic could tell.
    """
    part = whole.belief.part(whole.own)
    is_told = whole.growth <= MOST_GROWTH and bool(np.all(part.sd > ROUNDED_OFF * np.abs(part.mean)))
    return is_told and all(test.white and _of_the_sensor(test) for test in whole.residuals)


def _of_the_sensor(test: ResidualTest) -> bool:
    """No more is left than the sensor's own errors: so it is of an axis at rest, too, none of whose readings are explained."""
    return test.rms <= thresholds.SENSORS * test.floor


def apart_sd(one: Belief, other: Belief) -> float:
    """The largest difference of a parameter between two estimates of the same names, in standard deviations of both together."""
    return float(np.max(np.abs(one.mean - other.mean) / np.hypot(one.sd, other.sd), initial=0.0))


def with_best_starts(runs: tuple[Run, ...], names: tuple[str, ...], theta: Array) -> Point:
    """Criterion (10) over these runs with the parameters held and the windows' starts fitted.

    A fit begins from these starts: over long windows guessed ones are so far off that parameters which follow them lose their way.
    """
    free = Prior(theta, np.zeros((theta.size, theta.size)))
    return solve(Problem(names, theta, np.abs(theta) + 1e-12, theta, theta, runs, free))


def _volume(found: Estimate) -> float:
    """The logarithm of the volume that the estimate leaves open."""
    part = found.belief.part(found.own)
    return float(np.linalg.slogdet(part.correlation)[1] / 2.0 + np.sum(np.log(part.sd)))
