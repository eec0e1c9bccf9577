"""The free curve that explains the logs best: what an effect outside the library does, fitted as effects are, with an evidence like theirs.

(1)  e = ln p(logs | theta, b) + ln p(theta) - b'b / 2 s^2 - ln |A| / 2 - ln |1 + s^2 G| / 2 - SHAPE_COST - ln n

by Laplace at the best theta and weights b of one of n curves, with A the information of theta, G that of b beyond it, s the spread of the
weights, by the largest evidence (MacKay 2003, chapter 28): one shape more. Gauss-Newton in b, theta and noise fitted anew
beside each step.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.curves import Curve, curves
from diagnosis.detect.linearisation import Linearisation, Scores, linearised
from diagnosis.filter.filter_input import Added
from diagnosis.filter.kalman import Disturbances
from diagnosis.fit.coloured_noise import coloured_noise_of
from diagnosis.fit.evidence import FittedHypothesis, log_evidence
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import with_memory_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, has_memory
from jobs.thread_map import thread_map

Array = NDArray[np.float64]
SPREADS = np.logspace(-0.5, 4.0, 19)  # of weights, in units of what the logs tell of the one that they tell most of
ROUNDS = 8
PARTS = (1.0, 0.5, 0.25, 0.1, 0.03)  # of a step, until one leads up
LEAST_GAIN = 1.0  # nats, of a round: less is an end
AT_ONCE = 256  # weights that the filter answers at once


@dataclass(frozen=True, eq=False)
class FittedCurve:
    """A curve with its weights b (k,) and their `covariance` (k, k), the plant's fit beside it and its evidence; `case` are the logs with
    what it adds to them, `ahead_nats` is by how much it predicts them better than the plant alone, where that was asked."""

    curve: Curve
    b: Array
    covariance: Array
    case: Case
    fit: Fit
    evidence: float
    ahead_nats: float = 0.0

    def along(self, linearisation: Linearisation) -> Case:
        """Other logs of the plant, of which `linearisation` is, with what the curve adds to them."""
        return _added(linearisation.case, self.curve.along(linearisation), self.b)


class _Reached(NamedTuple):
    """The logs with what weights b (k,) of a curve add to them, and the plant's fit to these."""

    case: Case
    fit: Fit
    b: Array


class _Weights(NamedTuple):
    """Weights to first order: their evidence, their variance s^2, and the step to them."""

    evidence: float
    variance: float
    step: Array


def free_curve(
    case: Case, retuned: FittedHypothesis, linearisation: Linearisation, known: FittedHypothesis
) -> FittedCurve | None:
    """The most evident of the curves beside the plant alone, which is `retuned` with its `linearisation`; None where none gains.

    Those that promise a fair share of what the best does are fitted, as few as of any kind, with noise with a memory where the hypothesis
    that is `known` has some, as both are compared.
    """
    found = curves(linearisation)
    promised = _promised(linearisation, found)
    best = max(promised, default=0.0)
    order = sorted(range(len(found)), key=lambda index: -promised[index])[: decisions.NEXT]
    asked = [
        found[index]
        for index in order
        if promised[index] >= max(decisions.PROMISED_SHARE * best, decisions.chance_nats())
    ]
    fitted = thread_map(
        lambda curve: _fitted(case, retuned.fit, linearisation, curve, len(found), known.fit.hypothesis), asked
    )
    likeliest = max(fitted, key=lambda entry: entry.evidence, default=None)
    return likeliest if likeliest is not None and likeliest.evidence > retuned.evidence else None


def _promised(linearisation: Linearisation, found: Sequence[Curve]) -> list[float]:
    """What each curve gains in evidence, to first order."""
    gains = [0.0] * len(found)
    for target, places in _batches(found):
        batch = [found[place] for place in places]
        ends = np.cumsum([0, *(curve.weights for curve in batch)]).tolist()
        spans = [slice(begin, end) for begin, end in pairwise(ends)]
        each = linearisation.scores_apart(_values(linearisation, batch, target), target, spans)
        for place, scores in zip(places, each, strict=True):
            gains[place] = _weights(scores, np.zeros(found[place].weights)).evidence
    return gains


def _batches(found: Sequence[Curve]) -> Iterator[tuple[int, list[int]]]:
    """Curves of one target, by place, no more than the filter answers at once."""
    for target in sorted({curve.target for curve in found}):
        batch, weights = list[int](), 0
        for place in (place for place, curve in enumerate(found) if curve.target == target):
            if weights + found[place].weights > AT_ONCE:
                yield target, batch
                batch, weights = [], 0
            batch.append(place)
            weights += found[place].weights
        yield target, batch


def _weights(scores: Scores, b: Array) -> _Weights:
    """The most evident spread of the weights of a linear problem at `b`, and the step to its top.

    (2)  ln E = g'(G + 1 / s^2)^-1 g / 2 - ln |1 + s^2 G| / 2,   g = G b - score,   as a score is what the logs would be answered with
    """
    G = scores.gram
    unit = max(float(np.diag(G).max()), 1e-300)
    curvature, directions = np.linalg.eigh(G / unit)
    curvature = np.maximum(curvature, 0.0)
    pull = directions.T @ (G @ b - scores.score) / np.sqrt(unit)
    volume = 1.0 + SPREADS[:, None] ** 2 * curvature
    told = 0.5 * np.sum(SPREADS[:, None] ** 2 * pull**2 / volume - np.log(volume), axis=1)
    best = int(np.argmax(told))
    variance = float(SPREADS[best]) ** 2 / unit
    step = np.linalg.solve(G + np.eye(len(G)) / variance, -scores.score - b / variance)
    return _Weights(float(told[best]), variance, np.asarray(step, float))


def _fitted(case: Case, start: Fit, begun: Linearisation, curve: Curve, count: int, known: Hypothesis) -> FittedCurve:
    """A curve fitted from the plant alone."""
    reached, there = _Reached(case, start, np.zeros(curve.weights)), begun
    for _ in range(ROUNDS):
        answers = _answers(there, [curve], curve.target)
        weights = _weights(there.scores_of(answers), reached.b)
        further = _further(case, reached, curve, weights, there.moved_by(answers @ weights.step))
        if further is None:
            break
        gained = _penalised(further, weights) - _penalised(reached, weights)
        reached, there = further, linearised(further.case, further.fit)
        if gained < LEAST_GAIN:
            break
    here, at, b = reached
    noisy = with_memory_of(here, at, known) if has_memory(case, known) else at
    if noisy.log_posterior > at.log_posterior:
        at, there = noisy, linearised(here, noisy)
    scores = there.scores_of(_answers(there, [curve], curve.target))
    variance = _weights(scores, b).variance
    covariance = np.asarray(np.linalg.inv(scores.gram + np.eye(len(b)) / variance), float)
    volume = float(len(b) * np.log(variance) - np.linalg.slogdet(covariance)[1])
    cost = 0.5 * float(b @ b) / variance + 0.5 * volume + decisions.SHAPE_COST + float(np.log(count))
    return FittedCurve(curve, b, covariance, here, at, log_evidence(at, case.library.effects) - cost)


def _further(case: Case, reached: _Reached, curve: Curve, weights: _Weights, theta: Array) -> _Reached | None:
    """A step of the weights and of `theta` further, the plant fitted anew; None where no part of the step leads up."""
    hypothesis = reached.fit.hypothesis
    for part in PARTS:
        b = reached.b + part * weights.step
        with_curve = _added(case, curve, b)
        found = fit(with_curve, replace(hypothesis, theta=hypothesis.theta + part * theta), rounds=2)
        if found is None:
            continue
        moved = _Reached(with_curve, found, b)
        if _penalised(moved, weights) > _penalised(reached, weights):
            again = fit(with_curve, coloured_noise_of(with_curve, found.hypothesis), rounds=3)
            return moved if again is None or again.log_posterior < found.log_posterior else moved._replace(fit=again)
    return None


def _penalised(reached: _Reached, weights: _Weights) -> float:
    """What a fit with its weights is worth, in nats, but for volumes."""
    return reached.fit.log_posterior - 0.5 * float(reached.b @ reached.b) / weights.variance


def _answers(linearisation: Linearisation, found: Sequence[Curve], target: int) -> Array:
    """What the weights of curves of one target, side by side, do to the whitened innovations (rows, weights)."""
    return linearisation.answer(_values(linearisation, found, target), target)


def _values(linearisation: Linearisation, found: Sequence[Curve], target: int) -> list[Disturbances]:
    """What those weights add by flight (steps, weights)."""
    moves, values = target < len(linearisation.case.library.states), list[Disturbances]()
    for flight, filter_input in enumerate(linearisation.filter_inputs):
        value = np.concatenate([curve.at(flight, filter_input.t_s) for curve in found], axis=1)
        if moves:
            value *= np.append(np.diff(filter_input.t_s), 0.0)[:, None]
        values.append(value.__getitem__)
    return values


def _added(case: Case, curve: Curve, b: Array) -> Case:
    """The logs with what a curve adds."""
    library = case.library
    flights = []
    for flight, t_s, values in zip(case.flights, curve.t_s, curve.values, strict=True):
        states, outputs = np.zeros((len(t_s), len(library.states))), np.zeros((len(t_s), len(library.outputs)))
        if curve.target < len(library.states):
            states[1:, curve.target] = np.cumsum(np.diff(t_s) * (values[:-1] @ b))
        else:
            outputs[:, curve.target - len(library.states)] = values @ b
        flights.append(replace(flight, filter_input=replace(flight.filter_input, added=Added(t_s, states, outputs))))
    return case.with_flights(flights)
