"""The diagnosis: from a plant and its logs to what the model lacks, in the order detect, search, weigh, check on the hold-out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from diagnosis.case import Case, make_case
from diagnosis.curve import shape_of
from diagnosis.detect import Detection, detect
from diagnosis.doubt import doubt
from diagnosis.fit import Fit, fit
from diagnosis.ground import Ground, ground_of
from diagnosis.holdout import Holdout, helpful, holdout_of, likeliest, overruled, worse
from diagnosis.hypothesis import Supposed, nothing_supposed, passes
from diagnosis.improved import estimates, improved_plant
from diagnosis.inputs import LOST_FRAMES
from diagnosis.kit import make_kit
from diagnosis.lost_frames import with_losses
from diagnosis.maps import band_map, region_map, removed_energy, time_map
from diagnosis.next_experiment import next_experiment
from diagnosis.notes import cannot_tell, notes_of
from diagnosis.places import place_shares
from diagnosis.result import Result
from diagnosis.retune import Retune, retune
from diagnosis.reveal import revealing_experiment
from diagnosis.screen import Look, look
from diagnosis.search import Search, search
from diagnosis.shrinkage import Predicted
from diagnosis.sparse import suggestion
from diagnosis.trial import Tried, evidence
from diagnosis.unknown import Suspect, left_beside, suspects
from diagnosis.unrest import FIRST_STEP, FIRST_UNREST, with_unrest
from diagnosis.usual import with_usual
from diagnosis.weigh import Weighed, alike, weigh
from diagnosis.wiring import demand_wiring
from records.diagnosis import Diagnosis, Firmware, Hypothesis, PlaceShare, Unknown
from records.errors import BadInput
from records.log import RunLog
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.effects.api import without_effects

ALARM = 0.01
PLAIN_TO_SEE = 40.0  # nats
ROUNDS = 4
SETTLED = 0.05


@dataclass(frozen=True, eq=False)
class Material:
    """Logs to fit and logs to check on, with the names of both and the rows that may be used of each."""

    logs: Sequence[RunLog]
    holdout: Sequence[RunLog]
    holdout_names: Sequence[str]
    used: Sequence[NDArray[np.bool_] | None]
    firmware: Firmware | None = None
    notes: tuple[str, ...] = ()
    tables: Sequence[
        ControllerTable | None
    ] = ()  # the controller that flew each hold-out log, None where it is not at hand
    names: Sequence[str] = ()  # of the logs to fit

    def noted(self, sentences: Sequence[str]) -> Self:
        """The same with further sentences."""
        return replace(self, notes=(*self.notes, *sentences))


def diagnose(bound: BoundPlant, material: Material) -> Result:
    """Find what `bound`, with its own effects, lacks to explain the logs. Raises BadInput where it cannot be run along them."""
    kit = make_kit(without_effects(bound) if bound.effects else bound)
    split = len(material.logs)
    case = make_case(kit, material.logs, material.used[:split], bound)
    checked = make_case(kit, material.holdout, material.used[split:], bound) if material.holdout else None
    nominal = nominal_fit(case)
    case = with_usual(case, nominal.supposed)
    ground = ground_of(case, nominal)
    case, lossy = with_losses(case, ground)
    ground = replace(ground, case=case)
    looks = look(case, ground, kit.candidates)
    detection = detect(case, ground, looks, lossy)
    stated = Tried((), nominal, evidence(nominal))
    if detection.p > ALARM:
        return _no_gap(case, checked, material, detection, stated, looks)
    demand_wiring(case, nominal, nominal_fit)
    found = search(case, nominal, kit.candidates, ground, looks, lossy)
    beyond = retune(case, nominal)
    detection = confirmed_by(detection, found, beyond)
    if detection.p > ALARM:
        return _no_gap(case, checked, material, detection, stated, looks)
    best = found.tried[0] if found.tried[0].effects else found.tried[-1]
    left = left_beside(detect(case, ground_of(case, best.fit), []), best.effects)
    weighed = weigh(found.tried, stated, left, None if beyond is None else beyond.score)
    blamed = suspects(detection)
    if checked is not None and weighed.tried and LOST_FRAMES in weighed.tried[0].effects:
        checked = with_losses(checked, ground_of(checked, nominal_fit(checked)))[0]
    holdout = _holdout(case, checked, material, stated)
    weighed = weighed if holdout is None else overruled(holdout, weighed, stated, left)
    doubts = doubt(case, found, weighed, material.names, 0.0 if holdout is None else worse(holdout, weighed))
    weighed, material = doubts.applied(weighed), material.noted(doubts.sentences)
    chosen = likeliest(weighed, stated, beyond)
    chosen = chosen if holdout is None else helpful(holdout, chosen)
    predicted = () if holdout is None else holdout.predicted(chosen)
    material = material if holdout is None or chosen is not holdout.base else material.noted(holdout.notes)
    return Result(
        diagnosis=_gap(case, material, detection, found, weighed, blamed, chosen, predicted, holdout, looks, beyond),
        plant=improved_plant(case, chosen.fit),
        case=case,
        detection=detection,
        search=found,
        weighed=weighed,
        left=left,
        suspects=tuple(blamed),
        chosen=chosen,
        predicted=predicted,
        shape=shape_of(found.ground, detection, blamed[0]) if blamed and weighed.nameless else None,
    )


def confirmed_by(detection: Detection, found: Search, beyond: Retune | None) -> Detection:
    """A small gap also needs effects or parameters that explain it: without a gap, evidence of x nats has a chance of exp(-x) at most."""
    if detection.largest > PLAIN_TO_SEE:
        return detection
    explained = [entry.evidence for entry in found.tried if entry.effects]
    explained += [] if beyond is None else [beyond.score]
    best = max(explained, default=found.nominal.evidence) - found.nominal.evidence
    return replace(detection, p=max(detection.p, float(np.exp(-max(best, 0.0)))))


def nominal_fit(case: Case) -> Fit:
    """The plant re-tuned within its spread, with the unrest that then remains."""
    supposed = nothing_supposed(case, FIRST_UNREST)
    found = fit(case, supposed, rounds=ROUNDS)
    for turn in range(ROUNDS):
        if found is None:
            raise BadInput(
                "plant",
                "diagnosis",
                "states that leave all bounds",
                "a plant that can follow these logs",
                "check units",
            )
        calmer = with_unrest(case, found.supposed, FIRST_STEP if turn < 2 else 0.1)
        settled = bool(np.max(np.abs(calmer.unrest - found.supposed.unrest), initial=0.0) < SETTLED)
        found = fit(case, calmer, rounds=ROUNDS)
        if settled and found is not None:
            break
    assert found is not None
    return found


def _holdout(case: Case, checked: Case | None, material: Material, retuned: Tried) -> Holdout | None:
    """The logs that check, None where there are none."""
    return None if checked is None else holdout_of(checked, material.holdout_names, material.tables, case, retuned)


def _gap(
    case: Case,
    material: Material,
    detection: Detection,
    found: Search,
    weighed: Weighed,
    blamed: Sequence[Suspect],
    chosen: Tried,
    predicted: tuple[Predicted, ...],
    holdout: Holdout | None,
    looks: Sequence[Look],
    beyond: Retune | None,
) -> Diagnosis:
    before, after = _innovations(case, found.nominal.fit.supposed), _innovations(case, _best(found).fit.supposed)
    energy = removed_energy(before, after)
    first = blamed[0] if blamed else None
    return Diagnosis(
        verdict="gap",
        false_alarm_probability=detection.p,
        places=place_shares(found, weighed, first.place if first else None, beyond.places if beyond else ()),
        when=time_map(case, energy),
        regions=region_map(case, energy),
        bands=band_map(case, before, after),
        firmware=material.firmware,
        effects=tuple(
            _hypothesis(case, weighed, tried, probability)
            for tried, probability in zip(weighed.tried, weighed.probabilities, strict=True)
        ),
        unknown=_unknown(found, detection, weighed, first),
        found=chosen.effects,
        shrinkage=None if holdout is None else holdout.shrinkage(predicted),
        next_experiment=next_experiment(case, weighed),
        notes=(*material.notes, *notes_of(case, looks, chosen, weighed)),
    )


def _unknown(found: Search, detection: Detection, weighed: Weighed, first: Suspect | None) -> Unknown:
    """The effect that no candidate explains; its form is asked for where nothing else is likelier."""
    if first is None:
        return Unknown(weighed.unknown)
    form = suggestion(found.ground, detection, first.place) if weighed.nameless else None
    return Unknown(weighed.unknown, first.place, first.class_text, form)


def _best(found: Search) -> Tried:
    return found.tried[0]


def _innovations(case: Case, supposed: Supposed) -> list[NDArray[np.float64]]:
    runs = passes(case, supposed)
    return [] if runs is None else [run.w for run in runs]


def _hypothesis(case: Case, weighed: Weighed, tried: Tried, probability: float) -> Hypothesis:
    classes = [case.kit.effects[name].class_text for name in tried.effects]
    own = estimates(case, tried.fit)
    single = len(tried.effects) == 1
    parameters = {
        symbol if single else f"{name}.{symbol}": entry for name in tried.effects for symbol, entry in own[name].items()
    }
    same = tuple(" + ".join(sorted(entry.effects)) for entry in alike(weighed, tried))
    return Hypothesis(" + ".join(tried.effects), " + ".join(classes), probability, parameters, same)


def _no_gap(
    case: Case,
    checked: Case | None,
    material: Material,
    detection: Detection,
    retuned: Tried,
    looks: Sequence[Look],
) -> Result:
    holdout = _holdout(case, checked, material, retuned)
    chosen = retuned if holdout is None else holdout.base
    predicted = () if holdout is None else holdout.predicted(chosen)
    material = material if holdout is None else material.noted(holdout.notes)
    ranked, blind = suspects(detection), cannot_tell(case, looks)
    places = (PlaceShare(ranked[0].place, 1.0),) if ranked else ()
    diagnosis = Diagnosis(
        verdict="cannot tell" if blind else "no gap",
        false_alarm_probability=detection.p,
        places=places,
        firmware=material.firmware,
        shrinkage=None if holdout is None else holdout.shrinkage(predicted),
        next_experiment=revealing_experiment(case, retuned.fit.supposed) if blind else None,
        notes=(*material.notes, *notes_of(case, looks, chosen, None)),
    )
    return Result(
        diagnosis=diagnosis,
        plant=improved_plant(case, chosen.fit),
        case=case,
        detection=detection,
        search=None,
        weighed=None,
        left=0.0,
        suspects=tuple(ranked),
        chosen=chosen,
        predicted=predicted,
    )


__all__ = ["Ground", "Material", "diagnose", "nominal_fit"]
