"""What logs that were not fitted say: whether a re-tune, an unknown effect and what is named hold there."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.prior import at_its_end
from diagnosis.decide.weighing import Weighed
from diagnosis.detect.instants import happens
from diagnosis.fit.evidence import FittedHypothesis, evidence
from diagnosis.fit.gauss_newton import seen_in_readings, unfitted
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import is_gust
from diagnosis.library.input_effects import LOST_FRAMES
from diagnosis.search.retune import Retune
from diagnosis.validate.prediction import WINDOW_S
from diagnosis.validate.shrinkage import Predicted, error, predict_all, shrinkage
from records.diagnosis import Shrinkage
from records.table import ControllerTable


@dataclass(frozen=True, eq=False)
class Holdout:
    """Logs that were not fitted, their names, the controller that flew each, None where it is not at hand, and the plant without effects
    that they are judged against: `base`, re-tuned within its spread, or as stated where that predicts better, as `notes` then tell."""

    case: Case
    names: Sequence[str]
    tables: Sequence[ControllerTable | None]
    base: FittedHypothesis
    notes: tuple[str, ...] = ()
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
    if not 0.0 < stated < decisions.HELPS * before:  # a plant that predicts no row has no error
        return trial
    found = unfitted(training, retuned.fit.hypothesis.process_noise)
    if found is None:
        return trial
    further = 100.0 * (float(np.sqrt(before / stated)) - 1.0)
    told = f"re-tuned within its spread the plant predicts the hold-out {further:.2g} % worse than as stated"
    notes = (f"{told}, so its parameters stay as stated",)
    return Holdout(case, names, tables, FittedHypothesis((), found, evidence(found)), notes)


def overruled(holdout: Holdout, weighed: Weighed, stated: FittedHypothesis, left: float) -> Weighed:
    """What the hold-out says of an unknown effect: real rigs always leave a little that no form explains, beside what was found.

    What has a size at the end of its range is not asked: it may predict well, and is not what it is called.
    """
    if not weighed.fitted or weighed.unknown < weighed.probabilities[0]:
        return weighed
    first = weighed.fitted[0]
    if left > decisions.LITTLE_LEFT * (first.evidence - stated.evidence) or any(
        at_its_end(name, first) for name in first.effects
    ):
        return weighed
    gone = holdout.shrinkage(holdout.predicted(first)).fraction
    return (
        weighed
        if gone is None or gone < decisions.NEARLY_ALL_GONE
        else weighed.with_unknown(min(1.0 - gone, weighed.unknown))
    )


def partly(holdout: Holdout, weighed: Weighed, left: float) -> tuple[Weighed, tuple[str, ...]]:
    """What is named and surely leaves most of the hold-out's error, far above what the sensors leave: as much of it is unknown; or
    hardly takes any of it, maybe none: NOT_BORNE_OUT. `left` are the nats that forms still gain beside it. Where parameters alone are
    likelier no name is asked."""
    if weighed.nameless or not weighed.fitted or weighed.retune > weighed.probabilities[0]:
        return weighed, ()
    first = weighed.fitted[0]
    told = holdout.shrinkage(holdout.predicted(first))
    far = _leaves_most(holdout, first, told, left)
    if told.fraction is None or not (far or _idle(holdout, first, told)):
        return weighed, ()
    gone, most = max(told.fraction, 0.0), 0.0 if told.fraction_ci95 is None else max(told.fraction_ci95[1], 0.0)
    share = f"{100.0 * gone:.0f} % of the hold-out's error away, {100.0 * most:.0f} % at most"
    note = f"{' + '.join(first.effects)} takes {share}: something else is missing"
    unknown = min(1.0 - gone, decisions.UNNAMED) if far else decisions.NOT_BORNE_OUT
    return weighed.with_unknown(max(unknown, weighed.unknown)), (note,)


def _idle(holdout: Holdout, fitted: FittedHypothesis, told: Shrinkage) -> bool:
    """Whether a hypothesis surely takes less than IDLE of the error away, and not surely HARDLY: a way of the training logs alone.

    Events, each of which is another one in each log, and the steps of a sensor, which make no prediction better, are not asked.
    """
    if any(seen_in_readings(name) or _is_event(holdout.case, fitted, name) for name in fitted.effects):
        return False
    return (
        told.fraction_ci95 is not None
        and told.fraction_ci95[0] <= decisions.HARDLY
        and told.fraction_ci95[1] < decisions.IDLE
    )


def _leaves_most(holdout: Holdout, fitted: FittedHypothesis, told: Shrinkage, left: float) -> bool:
    """Whether a hypothesis surely leaves most of the error, far above what the sensors leave.

    Where forms see next to nothing beside it, air as restless as it takes it to be may be all that is left. Events are not asked, nor
    what happens at random: lost frames, gusts.
    """
    if any(name == LOST_FRAMES or is_gust(name) or _is_event(holdout.case, fitted, name) for name in fitted.effects):
        return False
    floor = _floor(holdout.case, fitted, told)
    floor = floor if left > decisions.LEFT_NATS else _in_air(holdout.case, fitted, floor)
    far = max((told.rms_after[name] / max(floor[name], 1e-300) for name in told.rms_after), default=0.0)
    return far >= decisions.FAR_ABOVE_FLOOR and (
        told.fraction_ci95 is None or told.fraction_ci95[1] <= decisions.PARTLY_GONE
    )


def _floor(case: Case, fitted: FittedHypothesis, told: Shrinkage) -> dict[str, float]:
    """What the sensors leave of each output's error (RMS, in its unit), with the steps of those that a hypothesis takes to be coarse."""
    coarse = {
        sensor.output: fitted.fit.hypothesis.effects.get(f"{place}.quantization", {}).get("q", 0.0)
        for place, sensor in case.library.bound.model.places.sensors.items()
    }
    return {name: float(np.hypot(rms, coarse.get(name, 0.0) / np.sqrt(12.0))) for name, rms in told.rms_floor.items()}


def _in_air(case: Case, fitted: FittedHypothesis, floor: Mapping[str, float]) -> dict[str, float]:
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
    if all(map(seen_in_readings, weighed.fitted[0].effects)):
        return 0.0
    predicted = holdout.predicted(weighed.fitted[0])
    return error(holdout.case, predicted, "after") / _without(holdout, predicted)


def helpful(holdout: Holdout, first: FittedHypothesis) -> FittedHypothesis:
    """What is to be added if it lowers the hold-out's error, else the plant without it."""
    predicted = holdout.predicted(first)
    helps = error(holdout.case, predicted, "after") < decisions.HELPS * _without(holdout, predicted)
    return first if helps else holdout.base


def likeliest(weighed: Weighed, stated: FittedHypothesis, beyond: Retune | None) -> FittedHypothesis:
    """The most probable hypothesis or re-tune if it beats an unknown effect, else the plant as `stated`."""
    if weighed.fitted and sum(weighed.probabilities) > max(weighed.unknown, weighed.retune):
        return weighed.fitted[0]
    return beyond.fitted if beyond is not None and weighed.retune > weighed.unknown else stated


def _without(holdout: Holdout, predicted: Sequence[Predicted]) -> float:
    """The hold-out's error without an effect, as stated or re-tuned, whichever is less; a plant that predicts no row does not count."""
    errors = [error(holdout.case, predicted, variant) for variant in ("nominal", "before")]
    return min((value for value in errors if value > 0.0), default=float("inf"))
