"""Which logs deny an effect that others show: a rig was changed between them, or one is of another rig of its kind."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation
from diagnosis.filter.kalman import Pass
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, Lack
from sim.effect import Effect, Values

Array = NDArray[np.float64]
Limits = tuple[float, float]


@dataclass(frozen=True)
class Part:
    """An effect in some logs alone: numbers of those that are without, its size in the unit of its column, and what it gains there, less
    the cost of the choice."""

    denied: frozenset[int]
    size: float
    gain: float


def choice_cost(case: Case) -> float:
    """Nats of a choice of two for each log."""
    return math.log(2.0) * len(case.flights)


def with_start(
    case: Case, hypothesis: Hypothesis, effect: Effect, values: Values, denied: frozenset[int]
) -> Hypothesis:
    """The hypothesis with a further effect, in all logs but those that deny it."""
    with_it = hypothesis.with_effects({**hypothesis.effects, effect.name: values})
    return with_it.lacking(effect.name, Lack(denied, effect.absent, choice_cost(case)) if denied else None)


def parts(
    linearisation: Linearisation, columns: Array, gains: Sequence[float], limits: Sequence[Limits]
) -> list[Part | None]:
    """For each of the columns (rows, k), slopes by a size within `limits` that gains `gains` in all logs, those in which it gains most,
    by first order: None where that is not TAKEN_IN nats more than in all."""
    case = linearisation.case
    if len(case.flights) < 2:
        return [None] * columns.shape[1]
    score, gram = scores_by_log(linearisation, columns)
    numbers, cost = [flight.number for flight in case.flights], choice_cost(case)
    found = [_best_part(g, G, within, numbers) for g, G, within in zip(score, gram, limits, strict=True)]
    paid = [None if part is None else replace(part, gain=part.gain - cost) for part in found]
    return [
        part if part is not None and part.gain > gain + decisions.TAKEN_IN else None
        for part, gain in zip(paid, gains, strict=True)
    ]


def scores_by_log(linearisation: Linearisation, columns: Array) -> tuple[Array, Array]:
    """Of each column (rows, k) the scores of the parts that are one log each (k, logs), and their products (k, logs, logs), the plant's
    coefficients taken out."""
    ends = np.cumsum([run.w.size for run in linearisation.runs])
    spans = [slice(first, last) for first, last in pairwise([0, *ends.tolist()])]
    slopes, w, logs = linearisation.slopes, linearisation.w, np.arange(len(spans))
    cross = np.stack([slopes[span].T @ columns[span] for span in spans])  # (logs, free, k)
    share = np.einsum("ij,ljk->lik", linearisation.solve, cross)
    own = np.stack([-(columns[span].T @ w[span]) for span in spans])
    score = own + np.einsum("lik,i->lk", share, linearisation.pull)
    gram = -np.einsum("lik,mik->klm", cross, share)
    gram[:, logs, logs] += np.stack([(columns[span] ** 2).sum(axis=0) for span in spans], axis=1)
    return score.T, gram


def _best_part(score: Array, gram: Array, within: Limits, numbers: Sequence[int]) -> Part | None:
    """The best of the parts that are together by the size which each log wants."""
    own = np.maximum(np.diag(gram), 1e-12)
    order = np.argsort(score / own)
    halves = [kept for count in range(1, len(order)) for kept in (order[:count], order[count:])]
    found = [_part(score, gram, kept, within, numbers) for kept in halves]
    return max((part for part in found if part), key=lambda part: part.gain, default=None)


def _part(score: Array, gram: Array, kept: NDArray[np.int64], within: Limits, numbers: Sequence[int]) -> Part | None:
    whole, norm = float(score[kept].sum()), float(gram[np.ix_(kept, kept)].sum())
    if norm <= 0.0:
        return None
    size = float(np.clip(whole / norm, *within))
    denied = frozenset(numbers) - {numbers[place] for place in kept.tolist()}
    return Part(denied, size, size * (whole - 0.5 * size * norm))


def part_of_finite(case: Case, before: Sequence[Pass], runs: Sequence[Pass], gain: float) -> Part | None:
    """The same of an effect at full size, which gains `gain` in all logs: those that are likelier with it; None where none is."""
    own = [run.log_likelihood - other.log_likelihood for run, other in zip(runs, before, strict=True)]
    denied = frozenset(flight.number for flight, nats in zip(case.flights, own, strict=True) if nats < 0.0)
    gained = sum(nats for nats in own if nats > 0.0) - choice_cost(case)
    shown_by_some = 0 < len(denied) < len(own)
    return Part(denied, 1.0, gained) if shown_by_some and gained > gain + decisions.TAKEN_IN else None
