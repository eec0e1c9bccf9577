"""The diagnosis: from a plant and its logs to what the model lacks, in the order detect, search, weigh, check on the hold-out."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.answer import gap, no_gap
from diagnosis.decide.doubt import contradicting, doubt
from diagnosis.decide.holdout import Holdout, helpful, holdout_of, likeliest, overruled, partly, worse
from diagnosis.decide.unknown import left_beside
from diagnosis.decide.weighing import Weighed, weigh
from diagnosis.decide.wiring import demand_wiring
from diagnosis.detect.detection import Detection, detect, form_scores
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.evidence import FittedHypothesis, evidence
from diagnosis.fit.gauss_newton import Fit, fit
from diagnosis.fit.process_noise import FIRST_STEP, process_noise_of
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.hypothesis.usual import with_usual
from diagnosis.library.effect_library import effect_library, is_gust
from diagnosis.library.input_effects import LOST_FRAMES
from diagnosis.result import Judged, Material, Result, Seen
from diagnosis.search.beam import Alone, Search, alone, search
from diagnosis.search.gusts import gusts
from diagnosis.search.lost_frames import with_losses
from diagnosis.search.presliding_friction import needed, yielding
from diagnosis.search.retune import Retune, retune
from records.errors import BadInput
from sim.added_effects import without_effects
from sim.bind import BoundPlant

ROUNDS = 4
SETTLED = 0.05


def diagnose(bound: BoundPlant, material: Material) -> Result:
    """Find what `bound`, with its own effects, lacks to explain the logs. Raises BadInput where it cannot be run along them."""
    seen = _seen(bound, material)
    if seen.detection.p > decisions.ALARM:
        return _nothing(seen, material, _holdout(seen, material))
    demand_wiring(seen.case, seen.retuned.fit, nominal_fit, "the logs to explain")
    seen, found = _explained(seen)
    if found is None:
        return _nothing(seen, material, _holdout(seen, material))
    beyond = retune(seen.case, seen.retuned.fit)
    seen = replace(seen, detection=confirmed_by(seen.detection, found, beyond))
    if seen.detection.p > decisions.ALARM:
        return _nothing(seen, material, _holdout(seen, material))
    judged = _judged(seen, material, found, beyond)
    seen = replace(seen, detection=borne_out(seen.detection, judged))
    if seen.detection.p > decisions.ALARM:
        return _nothing(seen, material, judged.holdout)
    return gap(seen, material, judged)


def _nothing(seen: Seen, material: Material, holdout: Holdout | None) -> Result:
    """The answer where no gap shows, with what logs that were not fitted say to that. Raises BadInput where they are wired otherwise."""
    if seen.checked is None:
        return no_gap(seen, material, holdout)
    together = seen.case.with_flights([*seen.case.flights, *seen.checked.flights])
    told = contradicting(together, seen.retuned.fit.hypothesis, [*material.names, *material.holdout_names])
    if told:
        demand_wiring(seen.checked, nominal_fit(seen.checked), nominal_fit, "the hold-out")
    return no_gap(seen, replace(material, notes=(*material.notes, *told)), holdout)


def _seen(bound: BoundPlant, material: Material) -> Seen:
    """Ask whether there is a gap at all."""
    library = effect_library(without_effects(bound) if bound.effects else bound)
    library.prepare()
    split = len(material.logs)
    case = make_case(library, material.logs, material.used[:split], bound)
    checked = make_case(library, material.holdout, material.used[split:], bound) if material.holdout else None
    return _looked_at(case, checked)


def _looked_at(case: Case, checked: Case | None) -> Seen:
    """Fit the plant alone, and look at the library beside it."""
    nominal = nominal_fit(case)
    case = with_usual(case, nominal.hypothesis)
    linearisation = linearised(case, nominal)
    case, lossy = with_losses(case, linearisation)
    linearisation = replace(linearisation, case=case)
    score_tests = score_effects(case, linearisation, case.library.candidates)
    retuned = FittedHypothesis((), nominal, evidence(nominal))
    return Seen(
        case,
        checked,
        retuned,
        linearisation,
        tuple(score_tests),
        lossy,
        detect(case, linearisation, score_tests, lossy),
    )


def _explained(seen: Seen) -> tuple[Seen, Search | None]:
    """What explains the gap, with axes that yield near rest where that is part of it; no search where no gap is left then.

    They are asked beside single effects first, as a rig that yields is searched in vain by a plant that sticks: there they must explain
    a good part of what an effect does, as what a second effect would explain often looks like yielding, and what is then found must
    still need them.
    """
    begun = _alone(seen)
    first = begun.best(decisions.YIELDING_ASKED)
    again = _yielding(seen, first, decisions.YIELDING_EARLY_SHARE * (first[0].evidence - seen.retuned.evidence))
    if again is not None:
        further = _searched(again)
        if needed(seen.case, again.retuned if further is None else further.fitted[0]):
            return again, further
    found = search(seen.case, seen.case.library.candidates, begun)
    again = _yielding(seen, found.fitted[: decisions.YIELDING_ASKED])
    if again is None:
        return seen, found
    further = _searched(again)
    best = again.retuned if further is None else further.fitted[0]
    return (again, further) if best.evidence > found.fitted[0].evidence else (seen, found)


def _yielding(seen: Seen, found: Sequence[FittedHypothesis], further: float = 0.0) -> Seen | None:
    """All anew with axes that yield near rest, where that explains the logs better beside one of those found; else None."""
    asked = list(found) if seen.retuned in found else [*found, seen.retuned]
    case = yielding(seen.case, asked, further)
    return None if case is seen.case else _looked_at(case, seen.checked)


def _searched(seen: Seen) -> Search | None:
    """What is found; None where there is no gap."""
    return None if seen.detection.p > decisions.ALARM else search(seen.case, seen.case.library.candidates, _alone(seen))


def _alone(seen: Seen) -> Alone:
    return alone(
        seen.case, seen.retuned, seen.case.library.candidates, seen.linearisation, seen.score_tests, seen.lossy
    )


def _judged(seen: Seen, material: Material, found: Search, beyond: Retune | None) -> Judged:
    """Weigh what was found, and check it on the hold-out."""
    case, retuned = seen.case, seen.retuned
    left, weighed = _weighed(seen, found, beyond)
    if max(weighed.retune, *weighed.probabilities, 0.0) < decisions.WELL_EXPLAINED:
        enough = retuned.evidence + decisions.GUST_EXPLAINS * (found.fitted[0].evidence - retuned.evidence)
        further = [entry for entry in gusts(case, retuned) if entry.evidence > enough]
        if further:
            found = replace(found, fitted=tuple(sorted((*found.fitted, *further), key=lambda entry: -entry.evidence)))
            left, weighed = _weighed(seen, found, beyond)
    holdout = _holdout(seen, material, weighed.fitted[0].effects if weighed.fitted else ())
    told: tuple[str, ...] = ()
    if holdout is not None:
        weighed, told = partly(holdout, overruled(holdout, weighed, retuned, left), left)
    doubts = doubt(case, found, weighed, material.names, 0.0 if holdout is None else worse(holdout, weighed))
    weighed, notes = doubts.applied(weighed), (*material.notes, *doubts.sentences, *told)
    chosen = likeliest(weighed, retuned, beyond)
    if holdout is not None:
        chosen = helpful(holdout, chosen)
        notes = (*notes, *holdout.notes) if chosen is holdout.base else notes
    return Judged(found, beyond, weighed, chosen, holdout, notes)


def _weighed(seen: Seen, found: Search, beyond: Retune | None) -> tuple[float, Weighed]:
    """What forms still gain beside the best that was found, and the probabilities; all that swings beside a gust is a form of its own."""
    best = found.fitted[0] if found.fitted[0].effects else found.fitted[-1]
    own = [name for name in best.effects if not is_gust(name)]
    left = left_beside(form_scores(linearised(seen.case, best.fit)), own)
    score = None if beyond is None else beyond.score
    return left, weigh(found.fitted, seen.retuned, left, score, seen.case.library.frictionless, seen.case.library.steps)


def _holdout(seen: Seen, material: Material, effects: Sequence[str] = ()) -> Holdout | None:
    """The logs to check on, None where there are none; where lost frames are among the `effects`, theirs are looked for."""
    checked = seen.checked
    if checked is None:
        return None
    if LOST_FRAMES in effects:
        checked = with_losses(checked, linearised(checked, nominal_fit(checked)))[0]
    return holdout_of(checked, material.holdout_names, material.tables, seen.case, seen.retuned)


def confirmed_by(detection: Detection, found: Search, beyond: Retune | None) -> Detection:
    """A small gap also needs effects of sure size, or parameters, that explain it: without a gap, evidence of x nats has a chance of
    exp(-x) at most."""
    if detection.largest > decisions.PLAIN_TO_SEE:
        return detection
    explained = [entry.evidence for entry in found.fitted if entry.effects and found.sure]
    explained += [] if beyond is None else [beyond.score]
    best = max(explained, default=found.nominal.evidence) - found.nominal.evidence
    return replace(detection, p=max(detection.p, float(np.exp(-max(best, 0.0)))))


def borne_out(detection: Detection, judged: Judged) -> Detection:
    """A small gap whose explanations do not hold, be it on the hold-out, is explained by nothing: evidence of 0 nats."""
    return (
        replace(detection, p=1.0)
        if detection.largest <= decisions.PLAIN_TO_SEE and judged.weighed.nameless
        else detection
    )


def nominal_fit(case: Case) -> Fit:
    """The plant re-tuned within its spread, with the process noise that then remains."""
    hypothesis = nominal_hypothesis(case, decisions.FIRST_PROCESS_NOISE)
    found = fit(case, hypothesis, rounds=ROUNDS)
    for turn in range(ROUNDS):
        if found is None:
            raise BadInput(
                "plant",
                "diagnosis",
                "states that leave all bounds",
                "a plant that can follow these logs",
                "check units",
            )
        refined_noise = process_noise_of(case, found, FIRST_STEP if turn < 2 else 0.1)
        settled = bool(
            np.max(np.abs(refined_noise.process_noise - found.hypothesis.process_noise), initial=0.0) < SETTLED
        )
        found = fit(case, refined_noise, rounds=ROUNDS)
        if settled and found is not None:
            break
    assert found is not None
    return found


__all__ = ["Material", "diagnose", "nominal_fit"]
