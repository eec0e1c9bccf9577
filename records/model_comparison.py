"""From what logs say of several explanations of a gap to how probable each is, by a law whose numbers are learned from sealed answers.

(1)  scale        = e^size (1 + formed)^power, nats that forms a little off the truth may cost: more where more is explained by them
(2)  ln weight_i  = evidence_i / scale + prior_i - further n_i + ahead a_i, n_i effects beside one, a_i nats of predictions over a second
(3)  ln weight_p  = evidence_p / scale + ahead a_p, of the plant's own parameters beyond their spread and no effect
(4)  odds of explained = e^z / (1 + e^d), z = intercept + left ln(1 + left / 5) + favour f, of the likeliest by (2) and (3): what is left
     beside it of what the best and then free forms gain; f is what logs say that were not fitted.
     d = min(c / scale - E, ahead (a_c - a)) - curve: a free curve of evidence c and a_c nats of predictions is one more hypothesis, with
     log odds of -curve before the data, beside the plant alone and all the others, E the log of the sum of 1 and of their weights by (2)
     and (3) without predictions, a the likeliest's. It follows whatever forms are a little off, row by row, and its signals are those
     that the logs had: so it must both explain more and predict better
(5)  P_i          = P(explained) weight_i / sum of weights

The rest is an effect's that no candidate explains. Of that the free curve has e^d / (1 + e^d); of what it leaves, where the likeliest has a
name, a share is right in part, as so many wrong names of one effect or several were.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Nats that the best of some three hundred free forms gains of noise alone, about ln 300: less says nothing of what is left. By 184 sealed
# answers 1 and 5 are as good, 10 and 20 worse; with 1 noise of a third of an encoder's step moves a probability by a fifth.
LEFT_BY_CHANCE = 5.0


@dataclass(frozen=True)
class Candidate:
    """An explanation by one effect or several ("a.b + c.d"): nats of its evidence beyond the plant alone, log odds before the data
    less what parameters beyond their spread cost, and nats by which it predicts the logs better than the plant alone over horizons from a
    row to a second, a reading for each second."""

    effect: str
    evidence_nats: float
    prior_nats: float
    ahead_nats: float = 0.0

    @property
    def further(self) -> int:
        """How many effects it has beside one."""
        return self.effect.count(" + ")


@dataclass(frozen=True)
class ModelComparison:
    """What is known of a gap's explanations: nats that the best of them gains (`gain_nats`), of these what rests on forms of effects
    (`formed_nats`), what free forms still gain beside it (`left_nats`), what logs that were not fitted say of the first (-1 to 1; None
    without such logs or a first), of parameters beyond their spread alone nats of evidence (None: there are none) and ahead, and nats of
    evidence of a free curve instead of all these, beside what earns no name as the best of them is (None: none gains any), and ahead."""

    candidates: tuple[Candidate, ...]
    gain_nats: float
    formed_nats: float
    left_nats: float
    favour: float | None = None
    parameters_nats: float | None = None
    parameters_ahead_nats: float = 0.0
    curve_nats: float | None = None
    curve_ahead_nats: float = 0.0

    @property
    def columns(self) -> Array:
        """What (2) and (3) are of: evidence, prior, n and a of each candidate, then of parameters alone (4, candidates + 1); what is not
        there has evidence of -inf."""
        named = [(one.evidence_nats, one.prior_nats, one.further, one.ahead_nats) for one in self.candidates]
        alone = -np.inf if self.parameters_nats is None else self.parameters_nats
        return np.array([*named, (alone, 0.0, 0.0, self.parameters_ahead_nats)]).T


@dataclass(frozen=True)
class ComparisonLaw:
    """The numbers of (1) to (4), and how often a wrong name is right in part, of a single effect and of several."""

    size: float
    power: float
    further: float
    ahead: float
    intercept: float
    left: float
    curve: float
    favour: float
    partly_single: float
    partly_several: float

    def scale_nats(self, formed_nats: float | Array) -> Array:
        """(1)"""
        return np.asarray(np.exp(self.size) * (1.0 + formed_nats) ** self.power)

    def log_weights(self, columns: Array, formed_nats: float | Array) -> Array:
        """(2) and (3): of `columns` (4, ...) of one comparison, or of many with their `formed_nats`, in the shape of a column."""
        evidence_nats, prior, further, ahead_nats = columns
        return np.asarray(
            evidence_nats / self.scale_nats(formed_nats) + prior - self.further * further + self.ahead * ahead_nats
        )

    def shares(self, told: ModelComparison) -> Array:
        """Of each candidate, then of parameters alone, of all that explains: weights of (2) and (3) over their sum (candidates + 1,)."""
        found = self.log_weights(told.columns, told.formed_nats)
        if not np.isfinite(found).any():
            return np.zeros(len(found))
        weights = np.exp(found - found.max())
        return np.asarray(weights / weights.sum())

    def explained(self, told: ModelComparison) -> float:
        """(4); 0 where nothing explains."""
        shares = self.shares(told)
        if not shares.any():
            return 0.0
        z = self.intercept + float(np.dot(self.coefficients, features(told, shares)))
        z -= float(np.logaddexp(0.0, self.curve_logit(told, shares)))
        return float(0.5 * (1.0 + np.tanh(0.5 * z)))

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Those of z, in the order of `features`."""
        return (self.left, self.favour)

    def curve_logit(self, told: ModelComparison, shares: Array) -> float:
        """d of (4), -inf without a free curve."""
        if told.curve_nats is None:
            return -np.inf
        evidence_nats, prior, further, _ = told.columns
        found = self.log_weights(np.array([evidence_nats, prior, further, 0.0 * prior]), told.formed_nats)
        rivals = float(np.logaddexp.reduce(np.append(found, 0.0)))
        explains = told.curve_nats / float(self.scale_nats(told.formed_nats)) - rivals
        predicts = self.ahead * (told.curve_ahead_nats - ahead_of(told, likeliest_of(told, shares)))
        return min(explains, predicts) - self.curve

    def partly(self, told: ModelComparison, shares: Array) -> float:
        """How often a part of a wrong likeliest is right."""
        first = likeliest_of(told, shares)
        if first is None:
            return 0.0
        return self.without_curve(told, shares) * (self.partly_several if first.further else self.partly_single)

    def without_curve(self, told: ModelComparison, shares: Array) -> float:
        """What a free curve leaves of that which no candidate explains."""
        return float(np.exp(-np.logaddexp(0.0, self.curve_logit(told, shares))))


def likeliest_of(told: ModelComparison, shares: Array) -> Candidate | None:
    """The candidate with the largest share; None where parameters alone have a larger one, or there is none."""
    place = int(np.argmax(shares))
    return told.candidates[place] if place < len(told.candidates) else None


def ahead_of(told: ModelComparison, first: Candidate | None) -> float:
    """Nats by which the likeliest predicts the logs better, be it parameters alone."""
    return told.parameters_ahead_nats if first is None else first.ahead_nats


def features(told: ModelComparison, shares: Array) -> tuple[float, ...]:
    """What z of (4) is a function of, by the shares of (2) and (3)."""
    first = likeliest_of(told, shares)
    evidence_nats = told.parameters_nats if first is None else first.evidence_nats
    left_nats = told.left_nats + max(told.gain_nats - max(evidence_nats or 0.0, 0.0), 0.0)
    return (float(np.log1p(left_nats / LEFT_BY_CHANCE)), told.favour or 0.0)


def law_of(numbers: Mapping[str, Any]) -> ComparisonLaw:
    """The law with these numbers."""
    return ComparisonLaw(**{field.name: float(numbers[field.name]) for field in fields(ComparisonLaw)})
