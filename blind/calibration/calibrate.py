"""The law of families of sealed answers, its weight decay chosen and its worth told by leaving one family out after another."""

from collections.abc import Sequence
from dataclasses import dataclass

from blind.calibration.examples import Example, Family
from blind.calibration.fit import fit, log_loss, of_shares, with_explained
from blind.scoring.statistics import calibration_error, honest_error, reliability
from records.errors import BadInput
from records.model_comparison import ComparisonLaw

DECAYS = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)  # coefficients per standard deviation of a feature of 3.2 logits down to 0.2
SEED = 1  # of the simulation of honest answers
Stated = list[tuple[float, bool]]


@dataclass(frozen=True)
class Quality:
    """How good probabilities of `answers` are: how many firsts were right, log loss in nats an answer (None: not on record), calibration
    error of ten bins, and that which honest ones would have by chance: median and 95th percentile."""

    answers: int
    right: int
    log_loss: float | None
    calibration_error: float
    honest: float
    honest_95: float


@dataclass(frozen=True)
class Calibration:
    """A law and its worth: on what it was fitted to (`inside`), on each family by a law of the others (`by_family`, together `outside`),
    and of what the answers stated themselves (None: not on record). `outside` also chose `decay`, one of six, and is kinder for it."""

    families: tuple[Family, ...]
    decay: float
    law: ComparisonLaw
    inside: Quality
    outside: Quality
    stated: Quality | None
    by_family: tuple[Quality, ...]


def calibrate(families: Sequence[Family]) -> Calibration:
    """Fit the law to all families; raises BadInput where there are not two different ones."""
    _demand_two(families)
    learned = [[entry for other in families if other is not one for entry in other.examples] for one in families]
    begun = [of_shares(examples) for examples in learned]
    laws = {decay: [with_explained(*halves, decay) for halves in zip(begun, learned, strict=True)] for decay in DECAYS}
    decay = min(reversed(DECAYS), key=lambda tried: _together(families, laws[tried]))
    left_out = laws[decay]
    examples = [entry for one in families for entry in one.examples]
    law = fit(examples, decay)
    told = [_firsts(other, one.examples) for other, one in zip(left_out, families, strict=True)]
    said = [entry.stated for entry in examples if entry.stated is not None]
    return Calibration(
        families=tuple(families),
        decay=decay,
        law=law,
        inside=quality(_firsts(law, examples), log_loss(law, examples)),
        outside=quality([entry for own in told for entry in own], _together(families, left_out)),
        stated=quality(said, None) if len(said) == len(examples) else None,
        by_family=tuple(
            quality(own, log_loss(other, one.examples))
            for own, other, one in zip(told, left_out, families, strict=True)
        ),
    )


def quality(firsts: Stated, loss: float | None) -> Quality:
    """The worth of probabilities of firsts."""
    error = calibration_error(reliability(firsts))
    return Quality(
        len(firsts), sum(right for _, right in firsts), loss, error, *honest_error([p for p, _ in firsts], SEED)
    )


def _firsts(law: ComparisonLaw, examples: Sequence[Example]) -> Stated:
    return [entry.first(law) for entry in examples]


def _together(families: Sequence[Family], laws: Sequence[ComparisonLaw]) -> float:
    """Log loss of each family by its own of the laws, all answers alike."""
    counts = [len(one.examples) for one in families]
    losses = [log_loss(law, one.examples) for law, one in zip(laws, families, strict=True)]
    return sum(n * loss for n, loss in zip(counts, losses, strict=True)) / sum(counts)


def _demand_two(families: Sequence[Family]) -> None:
    if len(families) < 2:
        got, remedy = f"{len(families)} family", "name a second one, of another kind of rig say"
        raise BadInput("families", "--family", got, "at least two, to leave one out", remedy)
