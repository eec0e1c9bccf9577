"""From evidence to probabilities that come true: hypotheses compared by a law that was learned (records/model_comparison.py)."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.prior import prior_odds
from diagnosis.decisions import held_against
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.search.exchange import is_twin
from diagnosis.search.free_curve import FittedCurve
from records.model_comparison import Candidate, ComparisonLaw, ModelComparison, ahead_of, law_of, likeliest_of
from records.reasons import Decision

Array = NDArray[np.float64]
LIKELIER_THAN_NOT = 0.5  # probability: likelier than all else together
RANKED = 12  # hypotheses that are told of


@dataclass(frozen=True, eq=False)
class Weighed:
    """Hypotheses with effects, most probable first, with their probabilities; that of an effect that no candidate explains; that of
    parameters beyond their spread; the scale in nats on which hypotheses are compared; that of the first some effects are right and others
    not; the comparison that all these follow from; and the nats by which what explains predicts the logs better than the plant alone, in
    the mean by its shares (None: nothing was tried)."""

    fitted: tuple[FittedHypothesis, ...]
    probabilities: tuple[float, ...]
    unknown: float
    retune: float
    scale: float
    decisions: tuple[Decision, ...] = ()
    partly: float = 0.0
    comparison: ModelComparison | None = None
    ahead_nats: float | None = None

    @property
    def nameless(self) -> bool:
        """Whether nothing that has a name is as probable as an unknown effect."""
        return self.unknown > max(self.retune, self.partly + max(self.probabilities, default=0.0))

    def without_names(self) -> "Weighed":
        """The same where nothing that was tried can be right, be it a name or the plant's own parameters."""
        return replace(self, probabilities=(0.0,) * len(self.probabilities), partly=0.0, retune=0.0, unknown=1.0)


@dataclass(frozen=True, eq=False)
class Explanations:
    """All that may explain a gap: hypotheses with effects, the plant without any, what forms still gain beside the best of them in nats,
    parameters beyond their spread alone with their evidence and a free curve (None: there are none); and the evidence that hypotheses have
    `beside` effects that are not worth a name."""

    named: tuple[FittedHypothesis, ...]
    nominal: FittedHypothesis
    library: EffectLibrary
    left_nats: float
    beyond: FittedHypothesis | None = None
    retune: float | None = None
    curve: FittedCurve | None = None
    beside: Mapping[FittedHypothesis, float] = field(default_factory=dict)

    def evidence_beside(self, entry: FittedHypothesis) -> float:
        """That of a hypothesis, alone or beside what has no name."""
        return max(entry.evidence, self.beside.get(entry, -np.inf))


@cache
def learned() -> ComparisonLaw:
    """The law of the file beside this one, which `twinlaw blind calibrate` writes."""
    return law_of(json.loads(files("diagnosis.decide").joinpath("comparison.json").read_text(encoding="utf-8"))["law"])


def weigh(
    explanations: Explanations,
    ahead: Mapping[FittedHypothesis, float],
    favour: float | None = None,
    law: ComparisonLaw | None = None,
) -> Weighed:
    """Probabilities of all that was tried, given that there is a gap; `ahead` are the nats by which what was asked predicts the logs better
    than the plant alone: what was not asked does so as little as any. `favour` is what logs that were not fitted say of the first."""
    learnt = learned() if law is None else law
    told = replace(_comparison(explanations, ahead), favour=favour)
    shares, explained = learnt.shares(told), learnt.explained(told)
    order = np.argsort(-shares[:-1], kind="stable")[:RANKED].tolist()
    first = likeliest_of(told, shares)
    partly = (1.0 - explained) * learnt.partly(told, shares)
    scale = float(learnt.scale_nats(told.formed_nats))
    return Weighed(
        tuple(explanations.named[index] for index in order),
        tuple(float(explained * shares[index]) for index in order),
        1.0 - explained - partly,
        float(explained * shares[-1]),
        scale,
        _rules(told, first, scale, explained),
        partly,
        told,
        _ahead_nats(told, explained * shares, (1.0 - explained) * (1.0 - learnt.without_curve(told, shares))),
    )


def _ahead_nats(told: ModelComparison, named: Array, curve: float) -> float | None:
    """What explains predicts better, in the mean by probabilities, of what is `named` and of the `curve`; None where nothing explains."""
    ahead = [*(one.ahead_nats for one in told.candidates), told.parameters_ahead_nats, told.curve_ahead_nats]
    weights = np.append(named, curve)
    return float(np.average(ahead, weights=weights)) if weights.any() else None


def _comparison(explanations: Explanations, ahead: Mapping[FittedHypothesis, float]) -> ModelComparison:
    """All of them in nats. What effects without a name gain beside the likeliest name they would gain beside the curve."""
    least = min(ahead.values(), default=0.0)
    nominal, effects, curve = explanations.nominal, explanations.library.effects, explanations.curve
    first = max(explanations.named, key=explanations.evidence_beside, default=nominal)
    found = explanations.evidence_beside(first)
    best = found if explanations.retune is None else max(found, explanations.retune)
    return ModelComparison(
        candidates=tuple(
            Candidate(
                " + ".join(entry.effects),
                explanations.evidence_beside(entry) - nominal.evidence,
                prior_odds(entry, effects, explanations.library.frictionless, explanations.library.steps)
                - beyond_spread(entry),
                ahead.get(entry, least),
            )
            for entry in explanations.named
        ),
        gain_nats=max(best - nominal.evidence, 0.0),
        formed_nats=max(found - read_off(explanations, first).evidence, 0.0),
        left_nats=explanations.left_nats,
        parameters_nats=None if explanations.retune is None else explanations.retune - nominal.evidence,
        curve_nats=None if curve is None else curve.evidence - nominal.evidence + found - first.evidence,
        curve_ahead_nats=0.0 if curve is None else curve.ahead_nats,
        parameters_ahead_nats=0.0 if explanations.beyond is None else ahead.get(explanations.beyond, least),
    )


def beyond_spread(entry: FittedHypothesis) -> float:
    """Nats that a hypothesis pays for the plant's parameters beyond their spread: no form that is a little off makes these cheaper."""
    beyond = np.maximum(np.abs(entry.fit.hypothesis.theta) - decisions.BEYOND_CHANCE, 0.0)
    return 0.5 * float(beyond @ beyond)


def read_off(explanations: Explanations, first: FittedHypothesis) -> FittedHypothesis:
    """That of `first` which is read off the logs, a sensor's steps, where it was tried alone: no form of it can be a little off."""
    exact = {name for name in first.effects if explanations.library.effects[name].shown_in_readings}
    return next((entry for entry in explanations.named if set(entry.effects) == exact), explanations.nominal)


def _rules(told: ModelComparison, first: Candidate | None, scale: float, explained: float) -> tuple[Decision, ...]:
    of = "plant" if first is None else first.effect
    return (
        held_against("told_apart", of, told.gain_nats, scale, "nats", "apart" if told.gain_nats > scale else "alike"),
        *_curve_rules(told, first, of),
        held_against("forms_left", of, told.left_nats, told.gain_nats, "nats", "counts"),
        held_against("explained", of, explained, LIKELIER_THAN_NOT, "probability", _odds(explained)),
    )


def _curve_rules(told: ModelComparison, first: Candidate | None, of: str) -> tuple[Decision, ...]:
    """What a free curve gains beside the best, and whether it predicts better than the likeliest; none without one."""
    if told.curve_nats is None:
        return ()
    least_nats = ahead_of(told, first)
    more = "explains more" if told.curve_nats > told.gain_nats else "explains less"
    better = "predicts better" if told.curve_ahead_nats > least_nats else "predicts no better"
    return (
        held_against("free_curve", of, told.curve_nats, told.gain_nats, "nats", more),
        held_against("free_curve_foresees", of, told.curve_ahead_nats, least_nats, "nats", better),
    )


def _odds(explained: float) -> str:
    return "likelier" if explained > LIKELIER_THAN_NOT else "less likely"


def alike(weighed: Weighed, first: FittedHypothesis) -> list[FittedHypothesis]:
    """Hypotheses of as many effects that these data hardly tell from `first`."""
    near = [
        entry
        for entry in weighed.fitted
        if entry is not first
        and len(entry.effects) == len(first.effects)
        and abs(entry.evidence - first.evidence) < decisions.surely_nats() * weighed.scale
    ]
    return sorted(near, key=lambda entry: abs(entry.evidence - first.evidence))[:6]


def chosen_of(
    weighed: Weighed, stated: FittedHypothesis, beyond: FittedHypothesis | None, share: float
) -> tuple[FittedHypothesis, tuple[Decision, ...]]:
    """The most probable hypothesis or re-tune if it beats an unknown effect, else the plant as `stated`; `share` as of `first_share`."""
    rival = max(weighed.unknown, weighed.retune)
    if share > rival:
        return weighed.fitted[0], (
            held_against("named_over_unknown", named(weighed), share, rival, "probability", "named"),
        )
    retuned = beyond is not None and weighed.retune > weighed.unknown
    outcome = "parameters" if retuned else "unknown"
    told = held_against("named_over_unknown", named(weighed), share, rival, "probability", outcome)
    return beyond if beyond is not None and retuned else stated, (told,)


def first_share(case: Case, weighed: Weighed) -> float:
    """How probable it is that the first name, or what data can hardly tell from it, says what is missing or a part of it."""
    told = zip(weighed.fitted, weighed.probabilities, strict=True)
    return weighed.partly + sum(
        p for entry, p in told if entry is weighed.fitted[0] or is_twin(case.library, entry, weighed.fitted[0])
    )


def named(weighed: Weighed) -> str:
    """The effects of the most probable hypothesis; "nothing" where none was fitted."""
    return " + ".join(weighed.fitted[0].effects) if weighed.fitted else "nothing"
