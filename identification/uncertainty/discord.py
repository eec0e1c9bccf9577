"""Runs fitted together that do not agree: what each says by itself beside what the others say, parameter by parameter."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification import thresholds
from identification.fit.information import inverse
from identification.fit.normal_equations import Point, alone
from identification.fit.problem import Problem

Array = NDArray[np.float64]
LEAST_SHARE = 0.01  # of a cost: first order does not bear more


@dataclass(frozen=True)
class Discord:
    """A parameter that one run tells otherwise than all others do: its value by that run, by the others, and sd between them.

    `against` is the other run's name where there are two, "the others" where there are more.
    """

    run: str
    against: str
    name: str
    sds: float
    own: float
    others: float


def discords(problem: Problem, point: Point) -> tuple[Discord, ...]:
    """The parameters in which a run is more than `CONTRADICTS` standard deviations away from the others, the farthest first.

    To first order about the common optimum theta: run i by itself would end at theta + A_i^-1 g_i, with its information A_i and its
    gradient g_i, window starts eliminated; the others likewise with the sums of theirs and what was known before. The weights are those
    of the common fit, whose residuals hold the disagreement: each side's covariance is taken by the share of its cost that would be left
    at its own optimum. That its residuals would be less correlated there is not counted, so that a discord is told late rather than early.
    """
    if len(point.runs) < 2:
        return ()
    weak, prior = np.diag(1.0 / problem.scale**2), problem.prior
    parts = [alone(point, number) for number in range(len(point.runs))]
    costs = [sum(float(block.residual @ block.residual) for block in own) for own in point.blocks]
    found: list[Discord] = []
    told = point.runs if len(point.runs) > 2 else point.runs[:1]  # of two, each is against the other
    against = "the others" if len(point.runs) > 2 else point.runs[1].name
    pull = prior.information @ (prior.mean - point.theta)
    for number, run in enumerate(told):
        own, own_cov = _optimum(point.theta, parts[number][0] + weak, parts[number][1], costs[number])
        rest = [part for place, part in enumerate(parts) if place != number]
        H, g = np.sum([part[0] for part in rest], axis=0), np.sum([part[1] for part in rest], axis=0)
        left = sum(costs) - costs[number]
        others, others_cov = _optimum(point.theta, H + prior.information + weak, g + pull, left)
        sds = np.abs(own - others) / np.sqrt(np.diag(own_cov) + np.diag(others_cov))
        found += [
            Discord(run.name, against, name, float(sds[place]), float(own[place]), float(others[place]))
            for place, name in enumerate(problem.names)
            if sds[place] > thresholds.CONTRADICTS
        ]
    return tuple(sorted(found, key=lambda entry: -entry.sds))


def _optimum(theta: Array, A: Array, g: Array, cost: float) -> tuple[Array, Array]:
    """theta + A^-1 g and A^-1, of a badly scaled positive definite A, by the share of `cost` that is left there."""
    covariance = inverse(A)
    step = covariance @ g
    share = 1.0 - float(g @ step) / cost if cost > 0.0 else 1.0
    return theta + step, covariance * max(share, LEAST_SHARE)
