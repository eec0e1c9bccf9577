"""From evidence to probabilities that mean something: tempered by how far the forms of the library may be from the truth."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.prior import prior_odds
from diagnosis.decisions import held_against
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from diagnosis.search.exchange import is_twin
from records.reasons import Decision
from sim.effect import Effect

Array = NDArray[np.float64]
RANKED = 12


@dataclass(frozen=True, eq=False)
class Weighed:
    """Hypotheses with effects, most probable first, with their probabilities; that of an effect that no candidate explains; that of
    parameters beyond their spread; the scale in nats on which hypotheses are compared; and the probability that of the first some effects
    are right and others not."""

    fitted: tuple[FittedHypothesis, ...]
    probabilities: tuple[float, ...]
    unknown: float
    retune: float
    scale: float
    decisions: tuple[Decision, ...] = ()
    partly: float = 0.0

    @property
    def nameless(self) -> bool:
        """Whether nothing that has a name is as probable as an unknown effect."""
        return self.unknown > max(self.retune, self.partly + max(self.probabilities, default=0.0))

    def with_names(self, factors: Array) -> "Weighed":
        """The same with the probability of each name times its factor (names,), all names together as probable as before."""
        shares = np.array(self.probabilities) * factors
        shares *= sum(self.probabilities) / shares.sum()
        order = np.argsort(-shares, kind="stable").tolist()
        return replace(
            self,
            fitted=tuple(self.fitted[index] for index in order),
            probabilities=tuple(float(shares[index]) for index in order),
        )

    def with_unknown(self, share: float) -> "Weighed":
        """The same with an unknown effect of probability `share`, all else in its old proportions; itself where nothing else is left."""
        known = sum(self.probabilities) + self.partly + self.retune
        if known <= 0.0:
            return self
        factor = (1.0 - share) / known
        return replace(
            self,
            probabilities=tuple(factor * value for value in self.probabilities),
            retune=factor * self.retune,
            partly=factor * self.partly,
            unknown=share,
        )


def weigh(
    fitted: Sequence[FittedHypothesis],
    nominal: FittedHypothesis,
    effects: Mapping[str, Effect],
    left: float,
    retune: float | None = None,
    frictionless: Collection[str] = (),
    steps: Mapping[str, float] = {},
) -> Weighed:
    """Probabilities of hypotheses given that there is a gap; `left` nats are what forms still gain beside the best of them, `retune`
    is the evidence for parameters beyond their spread, `frictionless` and `steps` as in prior.py."""
    named = [entry for entry in fitted if entry.effects]
    if not named:
        return _nameless(nominal, left, retune)
    first = max(named, key=lambda entry: entry.evidence)
    best = first.evidence
    whole = max(best - nominal.evidence, 0.0)
    formed = max(best - _read_off(named, first, nominal, effects).evidence, 0.0)
    scale = (
        decisions.ALIKE
        + decisions.OFF_FORM * formed**decisions.OFF_POWER
        + decisions.OFF_SHARE * min(formed, decisions.FARTHEST_GAIN)
    )
    tempered = np.array(
        [(entry.evidence - best) / scale - decisions.FURTHER * (len(entry.effects) - 1) for entry in named]
    )
    prior_chi_squared = np.array([_beyond_spread(entry) for entry in named])
    tempered -= prior_chi_squared - prior_chi_squared.min()
    scores = tempered + [prior_odds(entry, effects, frictionless, steps) for entry in named]
    expected = decisions.LEFT_NATS + decisions.LEFT_SHARE * whole
    # Something unknown stands beside the best name, so it pays for all that this pays for but how rare it is.
    unknown = decisions.LEFT_POWER * float(np.log(max(left, 1.0) / expected)) - decisions.UNKNOWN + tempered.max()
    other = -np.inf if retune is None else (retune - decisions.RETUNE_COST - best) / scale
    weights = np.exp(np.array([*scores, other, unknown]) - max(np.max(scores), unknown, other))
    weights /= weights.sum()
    order = np.argsort(-weights[:-2], kind="stable")[:RANKED]
    of = " + ".join(first.effects)
    rules = (
        held_against("forms_left", of, left, expected, "nats", "unknown likelier" if left > expected else "explained"),
        held_against(
            "told_apart", of, best - nominal.evidence, scale, "nats", _told_apart(best - nominal.evidence, scale)
        ),
    )
    chosen = tuple(named[index] for index in order)
    return Weighed(
        chosen,
        tuple(float(weights[index]) for index in order),
        float(weights[-1]),
        float(weights[-2]),
        scale,
        rules,
    )


def _told_apart(gain: float, scale: float) -> str:
    return "told from the plant alone" if gain > scale else "alike to the plant alone"


def _read_off(
    named: Sequence[FittedHypothesis],
    first: FittedHypothesis,
    nominal: FittedHypothesis,
    effects: Mapping[str, Effect],
) -> FittedHypothesis:
    """That of `first` which is read off the logs, a sensor's steps, where it was tried alone: no form of it can be a little off."""
    exact = {name for name in first.effects if effects[name].shown_in_readings}
    return next((entry for entry in named if set(entry.effects) == exact), nominal)


def _nameless(nominal: FittedHypothesis, left: float, retune: float | None) -> Weighed:
    """Where no effect was worth a fit: other parameters alone, or what no candidate explains."""
    if retune is None:
        return Weighed((), (), 1.0, 0.0, decisions.ALIKE)
    other = (retune - decisions.RETUNE_COST - nominal.evidence) / decisions.ALIKE
    unknown = decisions.LEFT_POWER * float(np.log(max(left, 1.0) / decisions.LEFT_NATS)) - decisions.UNKNOWN
    alone = float(1.0 / (1.0 + np.exp(np.clip(unknown - other, -500.0, 500.0))))
    return Weighed((), (), 1.0 - alone, alone, decisions.ALIKE)


def _beyond_spread(entry: FittedHypothesis) -> float:
    """Nats that a hypothesis pays for the plant's parameters beyond their spread: no form that is a little off makes these cheaper."""
    beyond = np.maximum(np.abs(entry.fit.hypothesis.theta) - decisions.FREE_SPREAD, 0.0)
    return 0.5 * float(beyond @ beyond)


def alike(weighed: Weighed, first: FittedHypothesis) -> list[FittedHypothesis]:
    """Hypotheses of as many effects that these data hardly tell from `first`."""
    near = [
        entry
        for entry in weighed.fitted
        if entry is not first
        and len(entry.effects) == len(first.effects)
        and abs(entry.evidence - first.evidence) < 3.0 * weighed.scale
    ]
    return sorted(near, key=lambda entry: abs(entry.evidence - first.evidence))[:6]


def likeliest(
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
        p for entry, p in told if entry is weighed.fitted[0] or is_twin(case, entry, weighed.fitted[0])
    )


def named(weighed: Weighed) -> str:
    """The effects of the most probable hypothesis; "nothing" where none was fitted."""
    return " + ".join(weighed.fitted[0].effects) if weighed.fitted else "nothing"
