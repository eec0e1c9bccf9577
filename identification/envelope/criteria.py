"""How well estimated signals match measured ones, signal by signal, and the weighted score by which ways are compared (seed 003, 3.6)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from identification.margins import REQUIRED_s, correlation, fit_percent, held_s, rms_error, share_outside

Array = NDArray[np.float64]

# The weights of Table 3.5 are not in the text that we have; these are ours: staying within the margins counts most.
WEIGHTS: Mapping[str, float] = MappingProxyType(
    {"points within the margins": 4.0, "three seconds within the margins": 3.0, "fit": 2.0, "correlation": 1.0}
)
UNFITTED: Mapping[str, float] = MappingProxyType({name: weight for name, weight in WEIGHTS.items() if name != "fit"})


@dataclass(frozen=True)
class Match:
    """One signal of one or several flights: percentage of points outside, shortest time held from a start on, fit and correlation.

    `error_margins` is the root mean square error in units of the signal's margin. Theil's fit alone does not rank estimates of a signal
    that is mostly noise: one as large as the noise that has nothing to do with it gets 1 - 1 / sqrt(2), 29 %, no motion at all gets 0.
    """

    signal: str
    outside_percent: float
    held_s: float
    fit_percent: float
    correlation: float
    error_margins: float


def matches(
    names: Sequence[str], measured: Array, estimated: Array, margins: Array, sample_period_s: float
) -> tuple[Match, ...]:
    """One match for each of the last axis' signals; measured and estimated are (flights, n, signals)."""
    found = []
    for i, name in enumerate(names):
        y, guess, margin = measured[:, :, i], estimated[:, :, i], float(margins[i])
        held = min(held_s(a, b, margin, sample_period_s) for a, b in zip(y, guess, strict=True))
        y, guess = y.ravel(), guess.ravel()
        outside, error = 100.0 * share_outside(y, guess, margin), rms_error(y, guess) / margin
        found.append(Match(name, outside, held, fit_percent(y, guess), correlation(y, guess), error))
    return tuple(found)


def passed(found: Sequence[Match]) -> bool:
    """The three-second rule (1.6.1): every signal stays within its margin for at least three seconds from the start on."""
    return all(match.held_s >= REQUIRED_s for match in found)


def flights_passed(measured: Array, estimated: Array, margins: Array, sample_period_s: float) -> int:
    """Number of flights, of the first axis, in which all signals keep the three-second rule."""
    names = [""] * len(margins)
    each = zip(measured, estimated, strict=True)
    return sum(passed(matches(names, y[None], guess[None], margins, sample_period_s)) for y, guess in each)


def outside_percent(found: Sequence[Match]) -> float:
    """Mean percentage of points outside over the signals."""
    return float(np.mean([match.outside_percent for match in found]))


def error_margins(found: Sequence[Match]) -> float:
    """Mean over the signals of the root mean square error in margins."""
    return float(np.mean([match.error_margins for match in found]))


def score_percent(found: Sequence[Match], weights: Mapping[str, float] = WEIGHTS) -> float:
    """Weighted mean over criteria and signals, 100 where all points are inside and the signals agree."""
    by_criterion = {
        "points within the margins": [100.0 - match.outside_percent for match in found],
        "three seconds within the margins": [100.0 * min(1.0, match.held_s / REQUIRED_s) for match in found],
        "fit": [match.fit_percent for match in found],
        "correlation": [100.0 * max(0.0, np.nan_to_num(match.correlation)) for match in found],
    }
    total = sum(weights.values())
    return float(sum(weight * np.mean(by_criterion[name]) for name, weight in weights.items()) / total)
