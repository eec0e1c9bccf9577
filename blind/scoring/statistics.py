"""The statistics of a score: an exact interval for a share, how far stated probabilities are from what happened, and how far by chance."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import beta


@dataclass(frozen=True)
class Bin:
    """Stated probabilities in [low, high): how many, their mean, the share that was right."""

    low: float
    high: float
    count: int
    stated: float
    right: float


def clopper_pearson(hits: int, cases: int, confidence: float = 0.95) -> tuple[float, float]:
    """Exact two-sided interval of a share (Clopper and Pearson 1934): quantiles of the beta distribution."""
    tail = 0.5 * (1.0 - confidence)
    low = 0.0 if hits == 0 else float(beta.ppf(tail, hits, cases - hits + 1))
    high = 1.0 if hits == cases else float(beta.ppf(1.0 - tail, hits + 1, cases - hits))
    return low, high


def reliability(stated: Sequence[tuple[float, bool]], bins: int = 10) -> tuple[Bin, ...]:
    """The non-empty ones of `bins` equal bins."""
    edges = np.linspace(0.0, 1.0, bins + 1)
    filled = []
    for low, high in pairwise(edges):
        inside = [(p, right) for p, right in stated if low <= p < high or (high == 1.0 and p >= 1.0)]
        if inside:
            shares = np.array(inside, float).mean(axis=0)
            filled.append(Bin(float(low), float(high), len(inside), float(shares[0]), float(shares[1])))
    return tuple(filled)


def calibration_error(bins: Sequence[Bin]) -> float:
    """Expected calibration error: sum over bins of share of cases times |stated - right|."""
    total = sum(entry.count for entry in bins)
    return sum(entry.count * abs(entry.stated - entry.right) for entry in bins) / total if total else 0.0


def honest_error(stated: Sequence[float], seed: int, bins: int = 10, draws: int = 1000) -> tuple[float, float]:
    """(median, 95th percentile) of the calibration error that so many answers have by chance where each is right exactly as often as
    `stated`; by `draws` simulations from `seed`. (0, 0) without answers."""
    p = np.asarray(stated, float)
    if not len(p):
        return 0.0, 0.0
    place = np.digitize(p, np.linspace(0.0, 1.0, bins + 1)[1:-1])
    right = np.random.default_rng(seed).random((draws, len(p))) < p
    errors = np.abs((p - right) @ np.eye(bins)[place]).sum(axis=1) / len(p)
    return float(np.median(errors)), float(np.percentile(errors, 95.0))
