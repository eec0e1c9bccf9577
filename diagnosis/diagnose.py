"""The diagnosis: from a plant and its logs to what the model lacks, in the order detect, search, weigh, check on the hold-out.

Every rule that has a say leaves a record on the way (records/reasons.py), and every end of the path has a name, the `Exit`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.answer import gap, no_gap
from diagnosis.decide.consequence import consequence, without_idle
from diagnosis.decide.doubt import contradicting, doubt
from diagnosis.decide.holdout import Holdout, added, asked, favour, holdout_of, preferred, surely_better
from diagnosis.decide.rows import EARLY, LATE, demand_rows, rows_in_doubt
from diagnosis.decide.unknown import left_beside
from diagnosis.decide.weighing import Foretold, Tried, Weighed, first_share, likeliest, weigh
from diagnosis.decide.wiring import demand_wiring
from diagnosis.decisions import decided, held_against
from diagnosis.detect.detection import detect, form_scores
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.between_rows import between_rows, straight
from diagnosis.fit.evidence import FittedHypothesis, evidence
from diagnosis.fit.gauss_newton import Fit
from diagnosis.fit.nominal import best_plain_fit, plain_beside, plain_fit, with_memory
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.usual import with_usual
from diagnosis.library.effect_library import effect_library
from diagnosis.result import Exit, Judged, Material, Result, Seen
from diagnosis.search.beam import Alone, Search, alone, search, with_twins
from diagnosis.search.draughts import Draught, draught, gust_shares, without_memory
from diagnosis.search.lost_frames import with_losses
from diagnosis.search.presliding_friction import needed, yielding
from diagnosis.search.retune import Retune, retune
from diagnosis.validate.fitted_logs import FittedLogs
from records.diagnosis import Firmware
from records.reasons import Decision, Note
from sim.added_effects import without_effects
from sim.bind import BoundPlant


def diagnose(bound: BoundPlant, material: Material) -> Result:
    """Find what `bound`, with its own effects, lacks to explain the logs. Raises BadInput where it cannot be run along them."""
    seen = _seen(bound, material)
    material = replace(material, notes=(*material.notes, *_columns(seen, material.firmware)))
    seen = _beside_noise(seen)
    if not _alarmed(seen.detection.p):
        return _nothing(seen, material, Exit.NOTHING_SEEN)
    seen, found = _explained(seen)
    if found is None:
        return _nothing(seen, material, Exit.YIELDING_EXPLAINS)
    beyond = retune(seen.case, seen.retuned.fit)
    seen = confirmed_by(seen, found, beyond)
    if not _alarmed(seen.detection.p):
        return _nothing(seen, material, Exit.UNEXPLAINED)
    seen, judged = _judged(seen, material, found, beyond)
    seen, stands = borne_out(seen, judged.weighed)
    if not stands:
        return _nothing(seen, replace(material, notes=judged.notes), Exit.NOT_BORNE_OUT, judged.holdout)
    seen, matters = of_consequence(seen, judged)
    if not matters:
        return _nothing(seen, replace(material, notes=judged.notes), Exit.TOO_SMALL, judged.holdout)
    return gap(seen, material, judged)


def _columns(seen: Seen, firmware: Firmware | None) -> tuple[Note, ...]:
    """What is to be known of the columns of the logs to explain; raises BadInput where they are not what they are called."""
    nominal, where = seen.retuned.fit, "the logs to explain"
    rows = () if _in_their_rows(firmware) else demand_rows(seen.case, nominal, where, _ways(firmware))
    return (*demand_wiring(seen.case, nominal, plain_fit, where), *rows)


def _in_their_rows(firmware: Firmware | None) -> bool:
    """Whether the controller's own code shows that each command stands in the row of its time."""
    return firmware is not None and firmware.bit_exact


def _ways(firmware: Firmware | None) -> tuple[int, ...]:
    """Commands may be logged late; early too where the controller's own code says so, else the plant itself may be late."""
    is_early = firmware is not None and (firmware.cause or "").startswith("early_output")
    return (LATE, EARLY) if is_early else (LATE,)


def _alarmed(p: float) -> bool:
    """Whether so large a gap has a chance without one that is small enough to look for a cause."""
    return p <= decisions.ALARM


def _nothing(seen: Seen, material: Material, reason: Exit, holdout: Holdout | None = None) -> Result:
    """The answer where no effect shows: a gust where the noise is one, else none. Raises BadInput where logs that were not fitted are
    wired otherwise."""
    gusty, rules = draught(seen.case, seen.retuned)
    seen = seen.because(*rules)
    if gusty is not None:
        return _gust(seen, material, gusty)
    if holdout is None:
        seen, holdout = _checked(seen, material)
    return _told(seen, material, holdout, reason)


def _gust(seen: Seen, material: Material, found: Draught) -> Result:
    """The answer where all that is missing is a torque that comes and goes: beside a plant whose noise is white."""
    gained = found.gusty.evidence - found.quiet.evidence
    p = min(1.0, float(np.exp(-gained)))
    seen = replace(seen, retuned=found.quiet, detection=replace(seen.detection, p=p))
    tried = Search((found.gusty, found.quiet), found.quiet, True, seen.linearisation, seen.score_tests)
    seen, judged = _judged(seen, material, tried, None)
    return gap(seen, material, judged)


def _told(seen: Seen, material: Material, holdout: Holdout | None, reason: Exit) -> Result:
    """The same, with what logs that were not fitted say to that."""
    if seen.checked is None:
        return no_gap(seen, material, holdout, reason)
    together = seen.case.with_flights([*seen.case.flights, *seen.checked.flights])
    told, rules = contradicting(together, seen.retuned.fit.hypothesis, [*material.names, *material.holdout_names])
    if told:
        demand_wiring(seen.checked, plain_fit(seen.checked), plain_fit, "the hold-out")
    return no_gap(seen.because(*rules), replace(material, notes=(*material.notes, *told)), holdout, reason)


def _seen(bound: BoundPlant, material: Material) -> Seen:
    """Ask whether there is a gap at all."""
    library = effect_library(without_effects(bound) if bound.effects else bound)
    library.prepare()
    split = len(material.logs)
    case = make_case(library, material.logs, material.used[:split], bound)
    checked = make_case(library, material.holdout, material.used[split:], bound, split) if material.holdout else None
    return _detected(case, checked)


def _detected(case: Case, checked: Case | None, beside: FittedHypothesis | None = None) -> Seen:
    """Fit the plant alone, and score the library beside it; where a gap shows, once more from where the best single effect left the plant's
    numbers, as slopes from the stated ones may lead to another hill."""
    nominal = best_plain_fit(case)
    held = case
    case, nominal, between = between_rows(case, nominal)
    nominal = with_memory(case, nominal)
    if checked is not None and case is not held:
        checked = straight(checked)
    seen = replace(_scored(case, checked, nominal, between), beside=beside)
    if not _alarmed(seen.detection.p):
        return seen
    seen = _with_names(seen)
    best = _alone(seen.still or seen).best(1)[0]
    again = plain_beside(case, best.fit)
    if again is None:
        return seen
    gain = evidence(again, case.library.effects) - seen.retuned.evidence
    better = gain > decisions.TAKEN_IN
    outcome = "the plant alone is fitted from there" if better else "the plant alone stays as it was fitted"
    rule = decided("plain_again", " + ".join(best.effects), gain, decisions.TAKEN_IN, outcome)
    return replace(_scored(case, checked, again, (*between, rule)), beside=beside) if better else seen.because(rule)


def _with_names(seen: Seen) -> Seen:
    """The same with single effects as fitted, without noise with a memory where the plant has any: beside that they explain little."""
    still = seen.still or _still(seen)
    if still is None:
        return replace(seen, begun=_alone(seen))
    return replace(seen, still=replace(still, begun=_alone(still)))


def _scored(case: Case, checked: Case | None, nominal: Fit, rules: tuple[Decision, ...]) -> Seen:
    """What the plant alone as fitted leaves to the library, and whether that is a gap."""
    case = with_usual(case, nominal.hypothesis)
    linearisation = linearised(case, nominal)
    case, lossy = with_losses(case, linearisation)
    linearisation = replace(linearisation, case=case)
    score_tests = score_effects(case, linearisation, case.library.candidates)
    retuned = FittedHypothesis((), nominal, evidence(nominal, case.library.effects))
    detection = detect(case, linearisation, score_tests, lossy)
    rules = (*rules, *detection.decisions, _false_alarm("logs", detection.p))
    return Seen(case, checked, retuned, linearisation, tuple(score_tests), lossy, detection, rules)


def _beside_noise(seen: Seen) -> Seen:
    """The same, from the plant without noise with a memory where a name is to be had for it: such noise follows any motion row by row, as
    slow as it is, and beside it a name would explain only what is fast. What follows does not foresee, so the best name there must
    predict the logs better over a second; where nothing shows beside the noise, it must be by far likelier."""
    still = seen.still or _still(seen)
    if still is None:
        return seen
    names = _alone(still)
    best = names.best(1)[0]
    rule, stands = (_foreseen if _alarmed(seen.detection.p) else _over_noise)(seen, best)
    if not stands:
        return seen.because(rule)
    chance = min(seen.detection.p, float(np.exp(-max(best.evidence - seen.retuned.evidence, 0.0))))
    found = replace(still, begun=names, detection=replace(seen.detection, p=chance), decisions=seen.decisions)
    return found.because(rule)


def _foreseen(seen: Seen, best: FittedHypothesis) -> tuple[Decision, bool]:
    """Whether the best name without noise with a memory predicts the logs better than the plant with it, and the rule; or whether that is
    larger than noise, as where two effects are missing at once."""
    shares = gust_shares(seen.case, seen.retuned.fit.hypothesis)
    largest = max(shares, key=lambda name: shares[name], default="plant")
    without = "a cause is looked for without noise"
    if shares.get(largest, 0.0) > decisions.USUAL_GUST:
        return decided("beyond_noise", largest, shares[largest], decisions.USUAL_GUST, without), True
    gain = FittedLogs(seen.case).gain(best.fit.hypothesis, seen.retuned.fit.hypothesis) if best.effects else 0.0
    stands = gain >= decisions.MATTERS
    outcome = without if stands else "a cause is looked for beside noise"
    return decided("beside_noise", " + ".join(best.effects) or "plant", gain, decisions.MATTERS, outcome), stands


def _over_noise(seen: Seen, best: FittedHypothesis) -> tuple[Decision, bool]:
    """Whether it is by far likelier, as dry friction is that they follow, and the rule."""
    gain = best.evidence - seen.retuned.evidence
    stands = bool(best.effects) and gain > decisions.OVER_NOISE
    outcome = "a cause is looked for" if stands else "noise"
    return decided("over_noise", " + ".join(best.effects) or "plant", gain, decisions.OVER_NOISE, outcome), stands


def _still(seen: Seen) -> Seen | None:
    """The same from the plant without noise with a memory; None where it has none, or cannot follow its logs then."""
    case = seen.case
    still = without_memory(case, seen.retuned)
    if still is None:
        return None
    linearisation = linearised(case, still.fit)
    score_tests = tuple(score_effects(case, linearisation, case.library.candidates))
    return replace(seen, retuned=still, linearisation=linearisation, score_tests=score_tests, begun=None, still=None)


def _false_alarm(of: str, p: float) -> Decision:
    return decided("false_alarm", of, p, decisions.ALARM, "a cause is looked for" if _alarmed(p) else "no gap")


def _explained(seen: Seen) -> tuple[Seen, Search | None]:
    """What explains the gap, with axes that yield near rest where that is part of it; no search where no gap is left then.

    They are asked beside single effects first, as a rig that yields is searched in vain by a plant that sticks: there they must explain
    a good part of what an effect does, as what a second effect would explain often looks like yielding, and what is then found must
    still need them.
    """
    begun = _alone(seen)
    first = begun.best(decisions.YIELDING_ASKED)
    seen, again = _yielding(seen, first, decisions.YIELDING_EARLY_SHARE * (first[0].evidence - seen.retuned.evidence))
    if again is not None:
        further = _searched(again)
        if needed(seen.case, again.retuned if further is None else further.fitted[0]):
            return again, further
    found = search(seen.case, seen.case.library.candidates, begun)
    seen, again = _yielding(seen, found.fitted[: decisions.YIELDING_ASKED])
    if again is None:
        return seen, found
    further = _searched(again)
    best = again.retuned if further is None else further.fitted[0]
    return (again, further) if best.evidence > found.fitted[0].evidence else (seen, found)


def _yielding(seen: Seen, found: Sequence[FittedHypothesis], further: float = 0.0) -> tuple[Seen, Seen | None]:
    """The same with the rules asked, and all anew with axes that yield near rest, where that explains the logs better beside one of those
    found; else None."""
    asked = list(found) if seen.retuned in found else [*found, seen.retuned]
    found_there = yielding(seen.case, asked, further)
    seen = seen.because(*found_there.decisions)
    if found_there.case is seen.case:
        return seen, None
    again = _beside_noise(_detected(found_there.case, seen.checked, found_there.beside))
    return seen, replace(again, decisions=(*seen.decisions, *again.decisions))


def _searched(seen: Seen) -> Search | None:
    """What is found; None where there is no gap."""
    if not _alarmed(seen.detection.p):
        return None
    return search(seen.case, seen.case.library.candidates, _alone(seen))


def _alone(seen: Seen) -> Alone:
    return seen.begun or alone(seen.case, seen.retuned, seen.linearisation, seen.score_tests, seen.lossy, seen.beside)


def _judged(seen: Seen, material: Material, found: Search, beyond: Retune | None) -> tuple[Seen, Judged]:
    """Weigh what was found, and check it on the hold-out."""
    logs = FittedLogs(seen.case)
    ranked = _ranked(seen, material, found, beyond, logs)
    wider = found if not ranked.weighed.fitted else with_twins(seen.case, found, ranked.weighed.fitted[0])
    if wider is not found:
        found = wider
        ranked = _ranked(seen, material, found, beyond, logs, ranked.holdout)
    seen, weighed, holdout, retuned = ranked.seen, ranked.weighed, ranked.holdout, seen.retuned
    doubts = doubt(seen.case, found, weighed, material.names)
    weighed, notes = doubts.applied(weighed), (*material.notes, *doubts.notes, *ranked.notes)
    share = first_share(seen.case, weighed)
    chosen, named_rules = likeliest(weighed, retuned, None if beyond is None else beyond.fitted, share)
    seen = seen.because(*doubts.decisions, *named_rules)
    if holdout is not None:
        chosen, told, rules = added(holdout, chosen, share if chosen.effects else 1.0)
        seen, notes = seen.because(*rules), (*notes, *told)
    notes = rows_in_doubt(seen.case, chosen, notes) if chosen.effects else notes
    return seen, Judged(found, beyond, weighed, chosen, holdout, notes)


@dataclass(frozen=True, eq=False)
class _Ranked:
    """What was found by what the logs and the hold-out say of it, the hold-out, and what is to be told of it."""

    seen: Seen
    weighed: Weighed
    holdout: Holdout | None
    notes: tuple[Note, ...] = ()


def _ranked(
    seen: Seen,
    material: Material,
    found: Search,
    beyond: Retune | None,
    logs: FittedLogs,
    known: Holdout | None = None,
) -> _Ranked:
    """What was found, ranked; `known` is a hold-out that was made before."""
    tried, idle = without_idle(logs, _tried(seen, found, beyond))
    weighed = weigh(tried)
    seen = seen.because(*found.decisions, *idle)
    seen, holdout = _checked(seen, material, weighed.fitted[0].effects if weighed.fitted else (), known)
    if holdout is None or not weighed.fitted:
        return _Ranked(seen.because(*weighed.decisions), weighed, holdout)
    nats, preferences = preferred(holdout, weighed)
    first = weigh(tried, Foretold(nats)).fitted[0]
    told, notes, rules = asked(holdout, first)
    weighed = weigh(tried, Foretold(nats, favour(told)))
    return _Ranked(seen.because(*preferences, *rules, *weighed.decisions), weighed, holdout, notes)


def _tried(seen: Seen, found: Search, beyond: Retune | None) -> Tried:
    """All that may explain the gap; what swings beside noise is a form of its own."""
    best = found.fitted[0] if found.fitted[0].effects else found.fitted[-1]
    library = seen.case.library
    left = left_beside(form_scores(linearised(seen.case, best.fit)), [library.effects[name] for name in best.effects])
    named = tuple(entry for entry in found.fitted if entry.effects)
    return Tried(named, seen.retuned, library, left, None if beyond is None else beyond.score)


def _checked(
    seen: Seen, material: Material, effects: Sequence[str] = (), known: Holdout | None = None
) -> tuple[Seen, Holdout | None]:
    """The logs to check on, None where there are none; where lost frames are among the `effects`, theirs are looked for. What is `known`
    of them already is not asked again."""
    checked = seen.checked
    if checked is None:
        return seen, None
    loses = any(checked.library.effects[name].loses_commands for name in effects)
    if known is not None and loses == (known.case is not checked):
        return seen.because(*known.decisions), known
    if loses:
        checked = with_losses(checked, linearised(checked, plain_fit(checked)))[0]
    holdout = holdout_of(checked, material.holdout_names, material.tables, seen.case, seen.retuned)
    return seen.because(*holdout.decisions), holdout


def confirmed_by(seen: Seen, found: Search, beyond: Retune | None) -> Seen:
    """A small gap also needs effects of sure size, or parameters, that explain it: without a gap, evidence of x nats has a chance of
    exp(-x) at most, and the larger of both chances is that of so large a gap without one."""
    detection = seen.detection
    small = detection.largest <= decisions.PLAIN_TO_SEE
    size = decided(
        "plain_to_see", "logs", detection.largest, decisions.PLAIN_TO_SEE, "must be explained" if small else "a gap"
    )
    if not small:
        return seen.because(size)
    explained = [entry.evidence for entry in found.fitted if entry.effects and found.sure]
    explained += [] if beyond is None else [beyond.score]
    best = max(explained, default=found.nominal.evidence) - found.nominal.evidence
    p = max(detection.p, float(np.exp(-max(best, 0.0))))
    return replace(seen.because(size, _false_alarm("what explains it", p)), detection=replace(detection, p=p))


def of_consequence(seen: Seen, judged: Judged) -> tuple[Seen, bool]:
    """Whether anything that was found changes what a model predicts, of the logs or surely of those that were not fitted.

    It is asked against the plain plant with its parameters moved; one that had to move them further than its file allows is no plant that
    is as stated, however well it then predicts.
    """
    weighed = judged.weighed
    if seen.detection.moved or weighed.retune > max(weighed.probabilities, default=0.0):
        return seen, True
    tried, shares = list(weighed.fitted), list(weighed.probabilities)
    if judged.beyond is not None:
        tried, shares = [*tried, judged.beyond.fitted], [*shares, weighed.retune]
    rules = consequence(seen.case, seen.retuned, tried, shares)
    if all(rule.value is None or rule.value >= decisions.MATTERS for rule in rules):
        return seen.because(*rules), True
    surely, told = (False, ()) if judged.holdout is None else surely_better(judged.holdout, weighed.fitted)
    return seen.because(*rules, *told), surely


def borne_out(seen: Seen, weighed: Weighed) -> tuple[Seen, bool]:
    """Whether a gap stands: a small one that is not sure does not whose explanations do not hold, be it on the hold-out; a name that may
    be right in part is none for it. Its chance stays what it is."""
    unsure = seen.detection.largest <= decisions.PLAIN_TO_SEE and seen.detection.p > decisions.SURE_GAP
    named, against = max(weighed.retune, *weighed.probabilities, 0.0), weighed.unknown + weighed.partly
    stands = not (unsure and against > named)
    outcome = "no gap: nothing that was found holds" if not stands else "stands"
    rule = held_against("borne_out", "what explains it", named, against, "probability", outcome)
    return (seen.because(rule) if unsure else seen), stands


__all__ = ["Material", "diagnose"]
