"""The answer put into its record: the verdict with places, times, effects, what the hold-out says, and the next experiment."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.decide.holdout import Holdout
from diagnosis.decide.unknown import Suspect, suspects
from diagnosis.decide.weighing import Weighed, alike, learned
from diagnosis.detect.form_scores import FormScores
from diagnosis.experiment.next_experiment import next_experiment
from diagnosis.experiment.revealing import revealing_experiment
from diagnosis.explain.curve import shape_of
from diagnosis.explain.error_response import error_responses
from diagnosis.explain.improved import estimates, improved_plant
from diagnosis.explain.maps import band_map, region_map, removed_energy, time_map
from diagnosis.explain.notes import notes_of
from diagnosis.explain.places import place_shares
from diagnosis.explain.sentences import sentences
from diagnosis.explain.sparse import suggestion
from diagnosis.explain.visibility import cannot_tell
from diagnosis.explain.whole_rows import whole_rows
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.linear_problem import tempered
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import passes
from diagnosis.result import Exit, Judged, Material, Result, Seen
from diagnosis.search.beam import Search
from records.diagnosis import Diagnosis, RankedHypothesis, Unknown


def gap(seen: Seen, material: Material, judged: Judged) -> Result:
    """The answer where something is missing."""
    case, found, weighed = seen.case, judged.search, judged.weighed
    blamed = _blamed(seen.detection.by_form, judged)
    before, after = _innovations(case, found.nominal), _innovations(case, found.fitted[0])
    energy = removed_energy(before, after)
    predicted = () if judged.holdout is None else judged.holdout.predicted(judged.chosen)
    holdout = judged.holdout
    known = _tempered(case, judged.chosen, weighed.scale)
    kept = holdout.notes if holdout is not None and judged.chosen is holdout.base else ()
    slipped = whole_rows(case, known, material.firmware)
    notes = (*judged.notes, *kept, *slipped, *notes_of(case, seen.tests, judged.chosen, weighed, material.names))
    diagnosis = Diagnosis(
        verdict="gap",
        false_alarm_probability=seen.detection.p,
        places=place_shares(
            found, weighed, blamed.place if blamed else None, judged.beyond.places if judged.beyond else {}
        ),
        when=time_map(case, energy),
        regions=region_map(case, energy),
        bands=band_map(case, before, after),
        error_responses=error_responses(found.linearisation),
        firmware=material.firmware,
        effects=tuple(
            _hypothesis(case, weighed, fitted, probability)
            for fitted, probability in zip(weighed.fitted, weighed.probabilities, strict=True)
        ),
        unknown=_unknown(found, seen.detection.by_form, weighed, blamed),
        partly=weighed.partly,
        found=judged.chosen.effects,
        shrinkage=None if judged.holdout is None else judged.holdout.shrinkage(predicted),
        next_experiment=next_experiment(case, weighed),
        notes=sentences(notes),
        verdict_reason=_reason(judged).value,
        decisions=seen.decisions,
        note_records=notes,
        comparison=weighed.comparison,
    )
    shape = shape_of(judged.curve, weighed.scale) if judged.curve is not None and weighed.nameless else None
    checked = None if holdout is None else holdout.case
    return Result(diagnosis, improved_plant(case, known), case, predicted, shape, checked)


def _reason(judged: Judged) -> Exit:
    """By which end a gap was told."""
    weighed = judged.weighed
    if judged.chosen.effects:
        return Exit.EFFECT_ADDED
    if weighed.nameless or not (weighed.probabilities or weighed.retune):
        return Exit.UNKNOWN_EFFECT
    return Exit.PARAMETERS_ALONE if weighed.retune >= max(weighed.probabilities, default=0.0) else Exit.NAMED_NOT_ADDED


def no_gap(seen: Seen, material: Material, holdout: Holdout | None, reason: Exit) -> Result:
    """The answer where nothing shows, or nothing could; `reason` is by which end."""
    case = seen.case
    chosen = seen.retuned if holdout is None else holdout.base
    predicted = () if holdout is None else holdout.predicted(chosen)
    told = () if holdout is None else holdout.notes
    blind = reason is Exit.TOO_UNSURE or cannot_tell(case, seen.tests)
    notes = (*material.notes, *told, *notes_of(case, seen.tests, chosen, None, material.names))
    diagnosis = Diagnosis(
        verdict="cannot tell" if blind else "no gap",
        false_alarm_probability=seen.detection.p,
        firmware=material.firmware,
        shrinkage=None if holdout is None else holdout.shrinkage(predicted),
        next_experiment=revealing_experiment(case, seen.retuned.fit.hypothesis) if blind else None,
        notes=sentences(notes),
        verdict_reason=(Exit.TOO_LITTLE_SEEN if blind and reason is Exit.NOTHING_SEEN else reason).value,
        decisions=seen.decisions,
        note_records=notes,
    )
    checked = None if holdout is None else holdout.case
    improved = improved_plant(case, _tempered(case, chosen, float(learned().scale_nats(0.0))))
    return Result(diagnosis, improved, case, predicted, None, checked)


def _blamed(by_form: FormScores, judged: Judged) -> Suspect | None:
    """Where something without a name would act: the free curve's place where one explains the logs, else that of the forms that explain
    most to first order."""
    curve = judged.curve
    if curve is None:
        return next(iter(suspects(by_form)), None)
    gain = curve.evidence - judged.search.nominal.evidence
    return Suspect(curve.curve.place, curve.curve.class_text, gain)


def _unknown(found: Search, by_form: FormScores, weighed: Weighed, first: Suspect | None) -> Unknown:
    """The effect that no candidate explains; its form is asked for where nothing else is likelier."""
    if first is None:
        return Unknown(weighed.unknown)
    form = suggestion(found.linearisation, by_form, first) if weighed.nameless else None
    return Unknown(weighed.unknown, first.place, first.class_text, form)


def _innovations(case: Case, fitted: FittedHypothesis) -> list[NDArray[np.float64]]:
    runs = passes(case, fitted.fit.hypothesis)
    return [] if runs is None else [run.w for run in runs]


def _hypothesis(case: Case, weighed: Weighed, fitted: FittedHypothesis, probability: float) -> RankedHypothesis:
    classes = [case.library.effects[name].class_text for name in fitted.effects]
    own = estimates(case, _tempered(case, fitted, weighed.scale))
    single = len(fitted.effects) == 1
    parameters = {
        symbol if single else f"{name}.{symbol}": entry
        for name in fitted.effects
        for symbol, entry in own[name].items()
    }
    same = [*_other_names(case, fitted.effects), *(entry.effects for entry in alike(weighed, fitted))]
    told = tuple(" + ".join(sorted(effects)) for effects in same)
    return RankedHypothesis(" + ".join(fitted.effects), " + ".join(classes), probability, parameters, told)


def _tempered(case: Case, fitted: FittedHypothesis, scale: float) -> FittedHypothesis:
    """The same with what is known of its numbers by the tempered likelihood that hypotheses are weighed by."""
    return replace(fitted, fit=tempered(case, fitted.fit, scale))


def _other_names(case: Case, effects: Sequence[str]) -> list[tuple[str, ...]]:
    """The same effects, one of them by another name that this plant has for it."""
    copies = ((other.name, other.copy_of) for other in case.library.effects.values() if other.copy_of in effects)
    return [tuple(copy if name == of else name for name in effects) for copy, of in copies]
