"""The law of families of sealed answers, its weight decay chosen and its worth told by leaving one family out after another."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blind.calibration.examples import Example, Family
from blind.calibration.logistic import Law, fit
from blind.scoring.statistics import calibration_error, honest_error, reliability
from records.errors import BadInput

Array = NDArray[np.float64]
DECAYS = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)  # coefficients per standard deviation of a feature of 3.2 logits down to 0.2
SEED = 1  # of the simulation of honest answers
SUREST = 1e-12  # no stated probability counts as nearer to 0 or 1


@dataclass(frozen=True)
class Quality:
    """How good probabilities of `answers` are: log loss in nats an answer, calibration error of ten bins, and that which honest ones would
    have by chance: median and 95th percentile."""

    answers: int
    right: int
    log_loss: float
    calibration_error: float
    honest: float
    honest_95: float


@dataclass(frozen=True)
class Calibration:
    """A law and its worth: on what it was fitted to (`inside`), on each family by a law of the others (`by_family`, together `outside`),
    and of what the answers stated themselves (None: not on record). `outside` also chose `decay`, one of six, and is kinder for it.
    `partly`: how often a wrong name is right in part, of one effect and of several."""

    families: tuple[Family, ...]
    decay: float
    law: Law
    inside: Quality
    outside: Quality
    stated: Quality | None
    by_family: tuple[Quality, ...]
    partly: tuple[float, float]


def calibrate(families: Sequence[Family]) -> Calibration:
    """Fit the law to all families; raises BadInput where there are not two different ones."""
    _demand_two(families)
    examples = [entry for one in families for entry in one.examples]
    decay = min(reversed(DECAYS), key=lambda tried: _log_loss(np.concatenate(_left_out(families, tried)), examples))
    law, left_out = fit(examples, decay), _left_out(families, decay)
    said = [entry.stated for entry in examples if entry.stated is not None]
    return Calibration(
        families=tuple(families),
        decay=decay,
        law=law,
        inside=quality(law.probability(examples), examples),
        outside=quality(np.concatenate(left_out), examples),
        stated=quality(np.array(said), examples) if len(said) == len(examples) else None,
        by_family=tuple(quality(p, one.examples) for p, one in zip(left_out, families, strict=True)),
        partly=(partly(examples, several=False), partly(examples, several=True)),
    )


def partly(examples: Sequence[Example], several: bool) -> float:
    """How often a wrong name of one effect, or of several, is right in part: Laplace's rule of succession, (k + 1) / (n + 2)."""
    wrong = [entry for entry in examples if entry.several is several and not entry.right]
    return (sum(entry.partly for entry in wrong) + 1) / (len(wrong) + 2)


def quality(p: Array, examples: Sequence[Example]) -> Quality:
    """The worth of probabilities p (examples,)."""
    right = [entry.right for entry in examples]
    error = calibration_error(reliability(list(zip(p.tolist(), right, strict=True))))
    return Quality(len(right), sum(right), _log_loss(p, examples), error, *honest_error(p.tolist(), SEED))


def _left_out(families: Sequence[Family], decay: float) -> list[Array]:
    """What a law of all other families says of each."""
    return [
        fit([entry for other in families if other is not one for entry in other.examples], decay).probability(
            one.examples
        )
        for one in families
    ]


def _log_loss(p: Array, examples: Sequence[Example]) -> float:
    right = np.array([entry.right for entry in examples])
    sure = np.clip(p, SUREST, 1.0 - SUREST)
    return float(-np.mean(np.where(right, np.log(sure), np.log(1.0 - sure))))


def _demand_two(families: Sequence[Family]) -> None:
    if len(families) < 2:
        got, remedy = f"{len(families)} family", "name a second one, of another kind of rig say"
        raise BadInput("families", "--family", got, "at least two, to leave one out", remedy)
