"""What logs that were not fitted say: how much better what was found predicts them, as one number with its standard error."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from diagnosis import decisions
from diagnosis.decide.weighing import LIKELIER_THAN_NOT
from diagnosis.decisions import held_against
from diagnosis.detect.instants import happens
from diagnosis.fit.evidence import FittedHypothesis, log_evidence
from diagnosis.fit.gauss_newton import unfitted
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import ELSEWHERE, Hypothesis, nominal_hypothesis
from diagnosis.validate.judged_logs import JudgedLogs
from diagnosis.validate.score import Errors, Score, score
from diagnosis.validate.shrinkage import Predicted, predict_all, shrinkage
from jobs.thread_map import thread_map
from records.diagnosis import Shrinkage
from records.reasons import Decision, Note
from records.table import ControllerTable
from sim.effect import Role

NATS = "nats a reading"


@dataclass(frozen=True, eq=False)
class Holdout:
    """Logs that were not fitted, their names, the controller that flew each, None where it is not at hand, and the plant without effects
    that they are judged against: `base`, re-tuned within its spread, or as stated where that predicts better, as `notes` then tell."""

    logs: JudgedLogs
    names: Sequence[str]
    tables: Sequence[ControllerTable | None]
    base: FittedHypothesis
    notes: tuple[Note, ...] = ()
    decisions: tuple[Decision, ...] = ()
    ways: dict[Hypothesis, Hypothesis] = field(default_factory=dict)

    @property
    def case(self) -> Case:
        """Of the logs."""
        return self.logs.case

    @property
    def readings(self) -> int:
        """See JudgedLogs."""
        return self.logs.readings

    def predicted(self, chosen: FittedHypothesis) -> tuple[Predicted, ...]:
        """Predictions by the plant as stated, by `base`, and with what was `chosen`."""
        own = self.foreseen(chosen.fit.hypothesis)
        variants = {"nominal": self.stated, "before": self.base.fit.hypothesis, "after": own}
        return predict_all(self.case, self.names, variants, self.logs.predictions)

    @cached_property
    def stated(self) -> Hypothesis:
        """The plant as stated, with the process noise of `base`."""
        nominal = nominal_hypothesis(self.case, decisions.FIRST_PROCESS_NOISE)
        return nominal.with_noise_of(self.base.fit.hypothesis)

    def foreseen(self, hypothesis: Hypothesis) -> Hypothesis:
        """What a hypothesis says of these logs: an event that happened in another log, and what others are without, counts only where it
        surely predicts these better, and noise, which is not judged, is its own or that of `base`, whichever predicts better."""
        if hypothesis not in self.ways:
            other, without = self.base.fit.hypothesis, self._without_events(hypothesis)
            usual = self.logs.under_better_noise(without, other)
            best, gained = usual, 0.0
            for way in self._eventful(hypothesis) if without is not hypothesis else ():
                eventful = self.logs.under_better_noise(way, other)
                told = score(self.logs.errors(eventful), self.logs.errors(usual))
                if is_surely_better(told) and told.gain > gained:
                    best, gained = eventful, told.gain
            self.ways[hypothesis] = best
        return self.ways[hypothesis]

    def _eventful(self, hypothesis: Hypothesis) -> Iterator[Hypothesis]:
        """The same with its events, and with what others are without: as they happened in another log, as logs of one simulation have them
        alike, or, of an event that lasts, as happened before these began."""
        yield hypothesis
        effects = self.case.library.effects
        for name, by_log in hypothesis.own.items():
            happened = [values for log, values in by_log.items() if log != ELSEWHERE and values != by_log[ELSEWHERE]]
            yield from (hypothesis.with_effects({**hypothesis.effects, name: {**values}}) for values in happened)
        for name, values in hypothesis.effects.items():
            instant = effects[name].having(Role.INSTANT)
            if instant is not None and effects[name].having(Role.DURATION) is None and happens(effects[name], values):
                before = {**values, instant.symbol: instant.lower}
                yield hypothesis.with_effects({**hypothesis.effects, name: before})

    def _without_events(self, hypothesis: Hypothesis) -> Hypothesis:
        effects, lacks = self.case.library.effects, hypothesis.lacks
        kept = {n: v for n, v in hypothesis.effects.items() if not happens(effects[n], v) and n not in lacks}
        return hypothesis if len(kept) == len(hypothesis.effects) else hypothesis.with_effects(kept)

    def errors_foreseen(self, hypothesis: Hypothesis) -> Errors:
        """The errors of what a hypothesis says of these logs."""
        return self.logs.errors(self.foreseen(hypothesis))

    def score(self, hypothesis: Hypothesis) -> Score:
        """By how much a hypothesis predicts these logs better than `base`; by nothing where all that it names happened in other logs."""
        if self._named(hypothesis) and not self._named(self.foreseen(hypothesis)):
            return Score(0.0, 0.0, 0.0)
        return score(self.errors_foreseen(hypothesis), self.logs.errors(self.base.fit.hypothesis))

    def score_of_plant(self, chosen: FittedHypothesis) -> Score:
        """The same of the plant that is left for these logs, whatever is named: its parameters count too. Parameters alone are held against
        those that are stated, as `base` has moved its own."""
        return score(self.errors_foreseen(chosen.fit.hypothesis), self.logs.errors(self._rival(chosen)))

    def score_of_longest(self, chosen: FittedHypothesis) -> Score:
        """The same of predictions over the longest horizon alone."""
        own, other = self.errors_foreseen(chosen.fit.hypothesis), self.logs.errors(self._rival(chosen))
        return score(own.of_longest(), other.of_longest())

    def _rival(self, chosen: FittedHypothesis) -> Hypothesis:
        return self.base.fit.hypothesis if chosen.effects else self.stated

    def _named(self, hypothesis: Hypothesis) -> list[str]:
        """The effects of a hypothesis that `base` lacks, noise apart."""
        return [
            name
            for name in hypothesis.effects
            if name not in self.base.fit.hypothesis.effects and not self.case.library.effects[name].is_noise
        ]

    def shrinkage(self, predicted: Sequence[Predicted]) -> Shrinkage:
        """How far the gap shrinks in these predictions."""
        return shrinkage(self.case, predicted, self.tables)


def holdout_of(
    case: Case,
    names: Sequence[str],
    tables: Sequence[ControllerTable | None],
    training: Case,
    retuned: FittedHypothesis,
) -> Holdout:
    """The logs of `case` with what judges them; `retuned` is the plant as the `training` logs have it."""
    trial = Holdout(JudgedLogs(case), names, tables, retuned)
    told = trial.score(trial.stated)
    better = is_surely_better(told)
    rule = held_against(
        "as_stated", "plant", told.gain, decisions.SURELY * told.sd, NATS, "as stated" if better else "re-tuned"
    )
    found = unfitted(training, retuned.fit.hypothesis) if better else None
    if found is None:
        return replace(trial, decisions=(rule,))
    notes = (Note("stated_predicts_better", "plant", {"worse": float(np.expm1(told.gain / _outputs(case)))}),)
    base = FittedHypothesis((), found, log_evidence(found, training.library.effects))
    return replace(trial, base=base, notes=notes, decisions=(rule,), ways={})


def _outputs(case: Case) -> int:
    """How many outputs the score is a sum over."""
    return max(
        1, int(np.any([np.isfinite(flight.filter_input.y).any(axis=0) for flight in case.flights], axis=0).sum())
    )


def with_held_out(ahead: Mapping[FittedHypothesis, float], holdout: Holdout) -> dict[FittedHypothesis, float]:
    """Nats by which each predicts the logs better than the plant alone: `ahead`, of the logs to explain, and those of the hold-out, in
    which what happened in other logs has no say."""
    gains = thread_map(lambda entry: holdout.score(entry.fit.hypothesis).gain, list(ahead))
    return {entry: nats + holdout.readings * gain for (entry, nats), gain in zip(ahead.items(), gains, strict=True)}


def is_surely_better(told: Score) -> bool:
    """Whether a difference of predictions is more than chance makes."""
    return told.gain > decisions.SURELY * told.sd


def asked(holdout: Holdout, first: FittedHypothesis) -> tuple[Score, tuple[Note, ...], tuple[Decision, ...]]:
    """What the logs say of a hypothesis, of the plant's parameters alone beside those that are stated; what is to be told of that, and its
    records."""
    of = " + ".join(first.effects) or "parameters"
    told = holdout.score(first.fit.hypothesis) if first.effects else holdout.score_of_plant(first)
    sure, left = is_surely_better(told), max(told.misfit, 0.0)
    missing = sure and left > told.gain
    outcome, further = "surely better" if sure else "not surely better", "something else is missing"
    rules = (
        held_against("hold_out_gain", of, told.gain, decisions.SURELY * told.sd, NATS, outcome),
        held_against("hold_out_left", of, left, told.gain, NATS, further if missing else "no objection"),
    )
    if not missing:
        return told, (), rules
    shares = {"gain_nats": told.gain / _outputs(holdout.case), "left_nats": told.misfit / _outputs(holdout.case)}
    return told, (Note("something_else_missing", of, shares),), rules


def favour(told: Score) -> float:
    """What speaks for a hypothesis less what it leaves: (gain - left) / (|gain| + left + SURELY sd), 0 where the logs are silent."""
    left = max(told.misfit, 0.0)
    whole = abs(told.gain) + left + decisions.SURELY * told.sd
    return (told.gain - left) / whole if 0.0 < whole < float("inf") else 0.0


def added(
    holdout: Holdout, first: FittedHypothesis, probability: float
) -> tuple[FittedHypothesis, tuple[Note, ...], tuple[Decision, ...]]:
    """What is to be added: what has more than half of all `probability` unless the hold-out is predicted worse by it, over all horizons or
    surely over the longest, for which a model is used; what has less only where it is predicted better, and over the longest no worse;
    else the plant without it, as is told then."""
    told, of = holdout.score_of_plant(first), " + ".join(first.effects) or "parameters"
    longest = holdout.score_of_longest(first)
    likely = probability > LIKELIER_THAN_NOT
    least = -float(decisions.MATTERS) if likely else float(decisions.MATTERS)
    lowest = -max(float(decisions.MATTERS), decisions.SURELY * longest.sd) if likely else 0.0
    rules = (
        held_against("added", of, told.gain, least, NATS, "nothing added" if told.gain < least else "added"),
        held_against("added_for_long", of, longest.gain, lowest, NATS, _no_worse(longest.gain >= lowest)),
    )
    if told.gain >= least and longest.gain >= lowest:
        return first, (), rules
    worst = min(told.gain, longest.gain if longest.gain < lowest else told.gain)
    gain_nats = worst / _outputs(holdout.case)
    unsure = Note("unsure", of, {"probability": probability, "gain_nats": gain_nats})
    worse = worst < -decisions.MATTERS
    return holdout.base, (Note("predicts_worse", of, {"worse_nats": -gain_nats}) if worse else unsure,), rules


def _no_worse(holds: bool) -> str:
    return "no worse over the longest horizon" if holds else "nothing added"
