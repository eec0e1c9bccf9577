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
    """What the law is told: the logit of the weight of all that explains the gap, what the hold-out says for the first name (-1 to 1),
    whether there is none, and how many effects that has beside one."""

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
    """log odds that one of the explanations is right = intercept + coefficients . features; and how often, where none was, a part of the
    first name was, of a single effect and of several."""

    intercept: float
    coefficients: tuple[float, ...]
    partly: tuple[float, float] = (0.0, 0.0)

    def probability(self, features: Features) -> float:
        """The chance that one of the names is right."""
        return float(1.0 / (1.0 + np.exp(-self.intercept - np.dot(self.coefficients, features.vector))))

    def part(self, features: Features) -> float:
        """The chance that none of the names is right, but a part of the first is."""
        return (1.0 - self.probability(features)) * self.partly[features.further > 0.0]


@cache
def learned() -> Law:
    """The law of the file beside this one."""
    kept = json.loads(files("diagnosis.decide").joinpath("calibration.json").read_text(encoding="utf-8"))
    coefficients = tuple(kept["coefficients"][name] for name in FEATURES)
    return Law(kept["intercept"], coefficients, (kept["partly"]["single"], kept["partly"]["joint"]))


def features_of(weighed: Weighed, favour: float | None) -> Features:
    """What the law is told; `favour` is None without a hold-out."""
    p = _listed(weighed)
    logit = np.log(max(p, 1e-12)) - np.log(max(1.0 - p, 1e-12))
    sure = float(np.clip(logit, -decisions.FARTHEST_LOGIT, decisions.FARTHEST_LOGIT))
    further = float(len(weighed.fitted[0].effects) - 1)
    return Features(sure, favour or 0.0, float(favour is None), further)


def _listed(weighed: Weighed) -> float:
    """The weight of all that explains the gap: names, and other parameters alone."""
    return sum(weighed.probabilities) + weighed.retune


def calibrated(weighed: Weighed, favour: float | None, law: Law | None = None) -> tuple[Weighed, tuple[Decision, ...]]:
    """What explains the gap together as probable as such explanations came true, each with its share of that; a part of the first as
    probable as such parts were; the rest is an unknown effect's. The records are the law's features and the first name's share."""
    listed = _listed(weighed)
    if not 0.0 < listed < 1.0 or not sum(weighed.probabilities):  # nothing to share, or nothing beside it
        return weighed, ()
    told, of, learnt = features_of(weighed, favour), named(weighed), learned() if law is None else law
    known, partly = learnt.probability(told), learnt.part(told)
    found = replace(
        weighed,
        probabilities=tuple(known * value / listed for value in weighed.probabilities),
        partly=partly,
        unknown=1.0 - known - partly,
        retune=known * weighed.retune / listed,
    )
    share = weighed.probabilities[0] / listed
    values = {**dict(zip(FEATURES, told.vector, strict=True)), "share": share}
    return found, (
        *_records(of, values),
        held_against("comes_true", of, known * share, found.unknown, "probability", _outcome(found)),
        held_against("partly_true", of, partly, found.unknown, "probability", "counts"),
    )


def _records(of: str, values: Mapping[str, float]) -> Sequence[Decision]:
    return [held_against(f"calibration_{name}", of, value, 0.0, "1", "counts") for name, value in values.items()]


def _outcome(found: Weighed) -> str:
    return "unknown likelier" if found.nameless else "name likelier"
