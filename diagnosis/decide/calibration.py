"""From weights to probabilities that come true: a logistic law of few numbers, learned from sealed answers by `twinlaw blind calibrate`."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

import numpy as np

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed, named
from diagnosis.decisions import held_against
from records.reasons import Decision

FEATURES = ("sure", "favour", "silent", "further")  # in the order of the law's coefficients


@dataclass(frozen=True)
class Features:
    """What the law is told of the first name: the logit of its weight, what the hold-out says for it (-1 to 1), whether there is none,
    and how many effects it has beyond one."""

    sure: float
    favour: float
    silent: float
    further: float

    @property
    def vector(self) -> tuple[float, ...]:
        """The features in the order of FEATURES."""
        return (self.sure, self.favour, self.silent, self.further)


@dataclass(frozen=True)
class Law:
    """log odds that the first name is right = intercept + coefficients . features."""

    intercept: float
    coefficients: tuple[float, ...]

    def probability(self, features: Features) -> float:
        """The chance that the first name is right."""
        return float(1.0 / (1.0 + np.exp(-self.intercept - np.dot(self.coefficients, features.vector))))


@cache
def learned() -> Law:
    """The law of the file beside this one."""
    kept = json.loads(files("diagnosis.decide").joinpath("calibration.json").read_text(encoding="utf-8"))
    return Law(kept["intercept"], tuple(kept["coefficients"][name] for name in FEATURES))


def features_of(weighed: Weighed, favour: float | None) -> Features:
    """What the law is told; `favour` is None without a hold-out."""
    p = weighed.probabilities[0]
    sure = float(
        np.clip(
            np.log(max(p, 1e-12)) - np.log(max(1.0 - p, 1e-12)), -decisions.FARTHEST_LOGIT, decisions.FARTHEST_LOGIT
        )
    )
    return Features(sure, favour or 0.0, float(favour is None), float(len(weighed.fitted[0].effects) - 1))


def calibrated(weighed: Weighed, favour: float | None, law: Law | None = None) -> tuple[Weighed, tuple[Decision, ...]]:
    """The first name as probable as such names came true, all else in its old proportions, but no other name above the first: what is over
    counts as unknown. The records are the law's features."""
    if not weighed.fitted or weighed.probabilities[0] >= 1.0:
        return weighed, ()
    told, of = features_of(weighed, favour), named(weighed)
    first = (learned() if law is None else law).probability(told)
    factor = (1.0 - first) / (1.0 - weighed.probabilities[0])
    others = [factor * value for value in weighed.probabilities[1:]]
    capped = [min(value, first) for value in others]
    found = replace(
        weighed,
        probabilities=(first, *capped),
        unknown=factor * weighed.unknown + sum(others) - sum(capped),
        retune=factor * weighed.retune,
    )
    values = dict(zip(FEATURES, told.vector, strict=True))
    return found, (
        *_records(of, values),
        held_against("comes_true", of, first, found.unknown, "probability", _outcome(found)),
    )


def _records(of: str, values: Mapping[str, float]) -> Sequence[Decision]:
    return [held_against(f"calibration_{name}", of, value, 0.0, "1", "counts") for name, value in values.items()]


def _outcome(found: Weighed) -> str:
    return "unknown likelier" if found.nameless else "name likelier"
