"""What logs that were not fitted say: whether a re-tune, an unknown effect and what is named hold there."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.prior import at_its_end
from diagnosis.decide.weighing import Weighed
from diagnosis.decisions import decided, held_against
from diagnosis.detect.instants import happens
from diagnosis.fit.evidence import FittedHypothesis, evidence
from diagnosis.fit.gauss_newton import unfitted
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.search.retune import Retune
from diagnosis.validate.prediction import WINDOW_S
from diagnosis.validate.shrinkage import Predicted, error, predict_all, shrinkage
from records.diagnosis import Shrinkage
from records.reasons import Decision, Note
from records.table import ControllerTable
from sim.effect import Role


@dataclass(frozen=True, eq=False)
class Holdout:
    """Logs that were not fitted, their names, the controller that flew each, None where it is not at hand, and the plant without effects
    that they are judged against: `base`, re-tuned within its spread, or as stated where that predicts better, as `notes` then tell."""

    case: Case
    names: Sequence[str]
    tables: Sequence[ControllerTable | None]
    base: FittedHypothesis
    notes: tuple[Note, ...] = ()
    decisions: tuple[Decision, ...] = ()
    kept: dict[FittedHypothesis, tuple[Predicted, ...]] = field(default_factory=dict)

    def predicted(self, chosen: FittedHypothesis) -> tuple[Predicted, ...]:
        """Predictions by the plant as stated, by `base`, and with what was `chosen`."""
        if chosen not in self.kept:
            self.kept[chosen] = self._predicted(chosen)
        return self.kept[chosen]

    def _predicted(self, chosen: FittedHypothesis) -> tuple[Predicted, ...]:
        stated = replace(
            nominal_hypothesis(self.case, decisions.FIRST_PROCESS_NOISE),
            process_noise=self.base.fit.hypothesis.process_noise,
        )
        variants = {"nominal": stated, "before": self.base.fit.hypothesis, "after": chosen.fit.hypothesis}
        return predict_all(self.case, self.names, variants)

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
    trial = Holdout(case, names, tables, retuned)
    predicted = trial.predicted(retuned)
    stated, before = (error(case, predicted, variant) for variant in ("nominal", "before"))
    better = 0.0 < stated < decisions.HELPS * before  # a plant that predicts no row has no error
    ratio = stated / before if before > 0.0 else float("nan")
    told = decided("as_stated", "plant", ratio, decisions.HELPS, "as stated" if better else "re-tuned")
    found = unfitted(training, retuned.fit.hypothesis.process_noise) if better else None
    if found is None:
        return replace(trial, decisions=(told,))
    notes = (Note("stated_predicts_better", "plant", {"worse": float(np.sqrt(before / stated)) - 1.0}),)
    return Holdout(
        case, names, tables, FittedHypothesis((), found, evidence(found, training.library.effects)), notes, (told,)
    )


def overruled(
    holdout: Holdout, weighed: Weighed, stated: FittedHypothesis, left: float
) -> tuple[Weighed, tuple[Decision, ...]]:
    """What the hold-out says of an unknown effect: real rigs always leave a little that no form explains, beside what was found.

    What has a size at the end of its range is not asked: it may predict well, and is not what it is called.
    """
    if not weighed.fitted or weighed.unknown < weighed.probabilities[0]:
        return weighed, ()
    first, of = weighed.fitted[0], named(weighed)
    enough = decisions.LITTLE_LEFT * (first.evidence - stated.evidence)
    little = left <= enough and not any(at_its_end(name, first) for name in first.effects)
    asked = held_against("little_left", of, left, enough, "nats", "hold-out asked" if little else "unknown stays")
    if not little:
        return weighed, (asked,)
    gone = holdout.shrinkage(holdout.predicted(first)).fraction
    nearly = gone is not None and gone >= decisions.NEARLY_ALL_GONE
    share = float("nan") if gone is None else gone
    told = decided("nearly_all_gone", of, share, decisions.NEARLY_ALL_GONE, "unknown overruled" if nearly else "stays")
    weighed = weighed.with_unknown(min(1.0 - gone, weighed.unknown)) if gone is not None and nearly else weighed
    return weighed, (asked, told)


def partly(holdout: Holdout, weighed: Weighed, left: float) -> tuple[Weighed, tuple[Note, ...], tuple[Decision, ...]]:
    """What is named and surely leaves most of the hold-out's error, far above what the sensors leave: as much of it is unknown; or
    hardly takes any of it, maybe none: NOT_BORNE_OUT. `left` are the nats that forms still gain beside it. Where parameters alone are
    likelier no name is asked."""
    if weighed.nameless or not weighed.fitted or weighed.retune > weighed.probabilities[0]:
        return weighed, (), ()
    first, of = weighed.fitted[0], named(weighed)
    told = holdout.shrinkage(holdout.predicted(first))
    leaves, far = _leaves_most(holdout, first, told, left)
    hardly, idle = _idle(holdout, first, told)
    asked = (*leaves, *hardly)
    if told.fraction is None or not (far or idle):
        return weighed, (), asked
    gone, most = max(told.fraction, 0.0), 0.0 if told.fraction_ci95 is None else max(told.fraction_ci95[1], 0.0)
    note = Note("something_else_missing", of, {"gone": gone, "gone_at_most": most})
    unknown = min(1.0 - gone, decisions.UNNAMED) if far else decisions.NOT_BORNE_OUT
    return weighed.with_unknown(max(unknown, weighed.unknown)), (note,), asked


def _idle(holdout: Holdout, fitted: FittedHypothesis, told: Shrinkage) -> tuple[tuple[Decision, ...], bool]:
    """Whether a hypothesis surely takes less than IDLE of the error away, and not surely HARDLY: a way of the training logs alone.

    Events, each of which is another one in each log, and the steps of a sensor, which make no prediction better, are not asked.
    """
    effects = holdout.case.library.effects
    if any(effects[name].shown_in_readings or _is_event(holdout.case, fitted, name) for name in fitted.effects):
        return (), False
    if told.fraction_ci95 is None:
        return (), False
    low, high = told.fraction_ci95
    idle = low <= decisions.HARDLY and high < decisions.IDLE
    of = " + ".join(fitted.effects)
    outcome = "unknown gains" if idle else "stays"
    return (
        decided("hold_out_gone_at_least", of, low, decisions.HARDLY, outcome),
        decided("hold_out_gone_at_most", of, high, decisions.IDLE, outcome),
    ), idle


def _leaves_most(
    holdout: Holdout, fitted: FittedHypothesis, told: Shrinkage, left: float
) -> tuple[tuple[Decision, ...], bool]:
    """Whether a hypothesis surely leaves most of the error, far above what the sensors leave.

    Where forms see next to nothing beside it, process noise as it takes it to be may be all that is left. Events are not asked, nor
    what happens at random: lost frames, gusts.
    """
    effects = holdout.case.library.effects
    if any(effects[name].is_random or _is_event(holdout.case, fitted, name) for name in fitted.effects):
        return (), False
    floor = _floor(holdout.case, fitted, told)
    floor = floor if left > decisions.LEFT_NATS else _with_process_noise(holdout.case, fitted, floor)
    far = max((told.rms_after[name] / max(floor[name], 1e-300) for name in told.rms_after), default=0.0)
    above, of = far >= decisions.FAR_ABOVE_FLOOR, " + ".join(fitted.effects)
    if told.fraction_ci95 is None:
        return (
            decided("floors_left", of, far, decisions.FAR_ABOVE_FLOOR, "unknown gains" if above else "stays"),
        ), above
    most = told.fraction_ci95[1]
    leaves = above and most <= decisions.PARTLY_GONE
    outcome = "unknown gains" if leaves else "stays"
    return (
        decided("floors_left", of, far, decisions.FAR_ABOVE_FLOOR, outcome),
        decided("partly_gone", of, most, decisions.PARTLY_GONE, outcome),
    ), leaves


def _floor(case: Case, fitted: FittedHypothesis, told: Shrinkage) -> dict[str, float]:
    """What the sensors leave of each output's error (RMS, in its unit), with the steps of those that a hypothesis takes to be coarse."""
    effects, sensors = case.library.effects, case.library.bound.model.places.sensors
    coarse = {
        sensors[effects[name].place].output: values[effects[name].symbol(Role.STEP)]
        for name, values in fitted.fit.hypothesis.effects.items()
        if effects[name].shown_in_readings
    }
    return {name: float(np.hypot(rms, coarse.get(name, 0.0) / np.sqrt(12.0))) for name, rms in told.rms_floor.items()}


def _with_process_noise(case: Case, fitted: FittedHypothesis, floor: Mapping[str, float]) -> dict[str, float]:
    """The floor with what the hypothesis' process noise q makes of a free axis within a predicted second: its
    variance grows with q t^3 / 3."""
    model, process_noise = case.library.bound.model, fitted.fit.hypothesis.process_noise.tolist()
    moved = {
        str(axis.position): 10.0**own * np.sqrt(WINDOW_S**3 / 12.0)
        for axis, own in zip(model.axes, process_noise, strict=True)
    }
    return {name: float(np.hypot(rms, moved.get(str(model.outputs[name]), 0.0))) for name, rms in floor.items()}


def _is_event(case: Case, fitted: FittedHypothesis, name: str) -> bool:
    """Whether an effect happens at an instant that is another one in each log: not where it was before all logs."""
    return happens(case.library.effects[name], fitted.fit.hypothesis.effects[name])


def worse(holdout: Holdout, weighed: Weighed) -> float:
    """How many times as large the hold-out's mean square error is with what is named as without; 0 for no name, and for the steps of a
    sensor alone: the hold-out's own readings show those, and no prediction gets better by them."""
    if not weighed.fitted or weighed.probabilities[0] < weighed.unknown:
        return 0.0
    if all(holdout.case.library.effects[name].shown_in_readings for name in weighed.fitted[0].effects):
        return 0.0
    predicted = holdout.predicted(weighed.fitted[0])
    return error(holdout.case, predicted, "after") / _without(holdout, predicted)


def helpful(holdout: Holdout, first: FittedHypothesis) -> tuple[FittedHypothesis, tuple[Decision, ...]]:
    """What is to be added if it lowers the hold-out's error, else the plant without it."""
    predicted = holdout.predicted(first)
    after, without = error(holdout.case, predicted, "after"), _without(holdout, predicted)
    helps = after < decisions.HELPS * without
    ratio = after / without if without > 0.0 else float("inf")
    outcome = "added" if helps else "nothing added"
    of = " + ".join(first.effects) or "parameters"
    return first if helps else holdout.base, (decided("helps", of, ratio, decisions.HELPS, outcome),)


def likeliest(
    weighed: Weighed, stated: FittedHypothesis, beyond: Retune | None
) -> tuple[FittedHypothesis, tuple[Decision, ...]]:
    """The most probable hypothesis or re-tune if it beats an unknown effect, else the plant as `stated`."""
    known, rival = sum(weighed.probabilities), max(weighed.unknown, weighed.retune)
    if weighed.fitted and known > rival:
        return weighed.fitted[0], (
            held_against("named_over_unknown", named(weighed), known, rival, "probability", "named"),
        )
    retuned = beyond is not None and weighed.retune > weighed.unknown
    outcome = "parameters" if retuned else "unknown"
    told = held_against("named_over_unknown", named(weighed), known, rival, "probability", outcome)
    return beyond.fitted if beyond is not None and retuned else stated, (told,)


def named(weighed: Weighed) -> str:
    """The effects of the most probable hypothesis; "nothing" where none was fitted."""
    return " + ".join(weighed.fitted[0].effects) if weighed.fitted else "nothing"


def _without(holdout: Holdout, predicted: Sequence[Predicted]) -> float:
    """The hold-out's error without an effect, as stated or re-tuned, whichever is less; a plant that predicts no row does not count."""
    errors = [error(holdout.case, predicted, variant) for variant in ("nominal", "before")]
    return min((value for value in errors if value > 0.0), default=float("inf"))
