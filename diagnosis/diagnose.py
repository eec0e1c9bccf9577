"""The diagnosis: from a plant and its logs to what the model lacks, in the order detect, search, weigh, check on the hold-out.

Every rule that has a say leaves a record on the way (records/reasons.py), and every end of the path has a name, the `Exit`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.answer import gap, no_gap
from diagnosis.confirmation import confirmed_by, is_noise, may_be_missing, of_consequence
from diagnosis.decide.clock import clock_in_doubt
from diagnosis.decide.consequence import curve_that_predicts, curve_with_held_out, foreseen, foreseen_rules
from diagnosis.decide.doubt import contradicting, doubt
from diagnosis.decide.holdout import Holdout, added, asked, favour, holdout_of, with_held_out
from diagnosis.decide.idle import shares_of, without_idle
from diagnosis.decide.range_ends import range_ends, within_ranges
from diagnosis.decide.rows import OTHER_ROWS, demand_rows, rows_in_doubt
from diagnosis.decide.unknown import left_beside
from diagnosis.decide.weighing import Explanations, Weighed, chosen_of, first_share, weigh
from diagnosis.decide.wiring import demand_wiring
from diagnosis.detect.form_scores import form_scores
from diagnosis.detect.linearisation import linearised
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import has_memory
from diagnosis.result import Exit, Judged, Material, Result, Seen
from diagnosis.screening import alarmed, alone_of, beside_noise, detected_anew, seen_of, with_tests
from diagnosis.search.beam import Search, search, with_twins
from diagnosis.search.draughts import Draught, draught, knocks
from diagnosis.search.free_curve import FittedCurve, free_curve
from diagnosis.search.lost_frames import with_losses
from diagnosis.search.presliding_friction import Yielding, changes_names, needed, yielding
from diagnosis.search.retune import Retune, retune
from diagnosis.validate.fitted_logs import FittedLogs
from jobs.thread_map import at_once
from records.diagnosis import Firmware
from records.reasons import Note
from sim.bind import BoundPlant


def diagnose(bound: BoundPlant, material: Material) -> Result:
    """Find what `bound`, with its own effects, lacks to explain the logs. Raises BadInput where it cannot be run along them."""
    material = _within_ranges(bound, material)
    seen = seen_of(bound, material)
    material = replace(material, notes=(*material.notes, *_columns(seen, material)))
    noisy, seen = _without_noise(seen)
    if not alarmed(seen.detection.p):
        return _nothing(seen, noisy, material, Exit.NOTHING_SEEN)
    seen, found = _explained(seen)
    if found is None:
        return _nothing(seen, noisy, material, Exit.YIELDING_EXPLAINS)
    seen, noise = is_noise(noisy, seen, found)
    if noise:
        return _nothing(seen, noisy, material, Exit.NOTHING_SEEN)
    beyond, curve, left = at_once(
        lambda: retune(seen.case, seen.retuned.fit),
        lambda: free_curve(seen.case, seen.retuned, seen.linearisation, found.fitted[0]),
        lambda: _left(seen.case, found),
    )
    confirmed = confirmed_by(seen, found, beyond)
    if not alarmed(confirmed.detection.p):
        return _nothing(confirmed, noisy, material, Exit.UNEXPLAINED)
    seen, judged = _judged(confirmed, material, _Found(found, left, beyond, curve))
    seen, left_by = of_consequence(seen, judged)
    if left_by is not None:
        perhaps = may_be_missing(judged) if left_by is Exit.TOO_UNSURE else ()
        return _nothing(seen, noisy, replace(material, notes=(*perhaps, *judged.notes)), left_by, judged.holdout)
    return _gap(seen, material, judged)


def _without_noise(noisy: Seen) -> tuple[Seen, Seen]:
    """What is seen beside noise, and without it where a cause is sought so. Noise with a memory also follows axes that creep where they are
    taken to stick, and hides beside that what else is missing: where nothing shows, it is asked whether they do."""
    seen = beside_noise(noisy)
    if alarmed(seen.detection.p) or not has_memory(seen.case, seen.retuned.fit.hypothesis):
        return noisy, seen
    there = yielding(seen.case, [seen.retuned])
    seen = seen.because(*there.decisions)
    if there.beside is None:
        return noisy, seen
    noisy = _anew(seen, there)
    return noisy, beside_noise(noisy)


def _within_ranges(bound: BoundPlant, material: Material) -> Material:
    """The material with nothing read where a sensor's range ends, as the logs to explain show."""
    split = len(material.logs)
    names = material.names or [f"log {number + 1}" for number in range(split)]
    ends = tuple(range_ends(bound, material.logs, material.used[:split], names))
    logs, holdout = ([within_ranges(log, ends) for log in some] for some in (material.logs, material.holdout))
    return replace(material, logs=logs, holdout=holdout, notes=(*material.notes, *(end.note for end in ends)))


def _columns(seen: Seen, material: Material) -> tuple[Note, ...]:
    """What is to be known of the columns of the logs to explain; raises BadInput where they are not what they are called."""
    nominal, where = seen.retuned.fit, "the logs to explain"
    rows = () if _in_their_rows(material.firmware) else _rows(seen, where)
    return (
        *demand_wiring(seen.case, nominal, plain_fit, where, material.names),
        *rows,
        *clock_in_doubt(seen.case, nominal),
    )


def _rows(seen: Seen, where: str) -> tuple[Note, ...]:
    """What is to be known of the rows of the columns; where inputs seem to move between rows, also of commands that are held, and late."""
    held = seen.held
    told = demand_rows(held.case, held.fit, where, beaten=held.beaten) if held else ()
    return told or demand_rows(seen.case, seen.retuned.fit, where)


def _in_their_rows(firmware: Firmware | None) -> bool:
    """Whether the controller's own code shows that each command stands in the row of its time."""
    return firmware is not None and firmware.bit_exact


def _nothing(seen: Seen, noisy: Seen, material: Material, reason: Exit, holdout: Holdout | None = None) -> Result:
    """The answer where no effect shows: a gust where the noise is one, of the plant as it was fitted with noise, whether or not names were
    sought without it; else none. White noise is one only where nothing shows beside it: friction that no name surely stands for is white
    noise too. Raises BadInput where logs that were not fitted are wired otherwise."""
    gusty, rules = draught(noisy.case, noisy.retuned)
    if gusty is None and not alarmed(noisy.detection.p):
        gusty, more = knocks(noisy.case, noisy.retuned)
        rules = (*rules, *more)
    seen = seen.because(*rules)
    if gusty is not None:
        return _gust(replace(noisy, decisions=seen.decisions), material, gusty)
    if holdout is None:
        seen, holdout = _checked(seen, material)
    return _told(seen, material, holdout, reason)


def _gust(seen: Seen, material: Material, found: Draught) -> Result:
    """The answer where all that is missing is a torque that comes and goes: beside a plant whose noise is white."""
    gained = found.gusty.evidence - found.quiet.evidence
    p = min(1.0, float(np.exp(-gained)))
    seen = with_tests(replace(seen, retuned=found.quiet, detection=replace(seen.detection, p=p)))
    search = Search((found.gusty, found.quiet), found.quiet, True, seen.linearisation, seen.tests)
    seen, judged = _judged(seen, material, _Found(search, _left(seen.case, search)))
    return _gap(seen, material, judged)


def _gap(seen: Seen, material: Material, judged: Judged) -> Result:
    """The answer where something is missing: rows of columns are in doubt no longer where it explains them. What is too small to be told
    explains none."""
    chosen, notes = judged.chosen, judged.notes
    notes = rows_in_doubt(seen.case, chosen, notes) if chosen.effects else notes
    return gap(seen, material, replace(judged, notes=notes))


def _told(seen: Seen, material: Material, holdout: Holdout | None, reason: Exit) -> Result:
    """The same, with what logs that were not fitted say to that."""
    if seen.checked is None:
        return no_gap(seen, material, holdout, reason)
    together = seen.case.with_flights([*seen.case.flights, *seen.checked.flights])
    told, rules = contradicting(together, seen.retuned.fit.hypothesis, [*material.names, *material.holdout_names])
    if told:
        told = (*told, *misplaced_held_out(seen.checked, material.holdout_names))
    return no_gap(seen.because(*rules), replace(material, notes=(*material.notes, *told)), holdout, reason)


def misplaced_held_out(checked: Case, names: Sequence[str]) -> tuple[Note, ...]:
    """What is to be told of columns of a hold-out that contradicts the logs to explain: that some may stand in other rows.

    Raises BadInput where a column of it is turned, exchanged with another, or surely late.
    """
    own = plain_fit(checked)
    demand_wiring(checked, own, plain_fit, "the hold-out", names)
    notes = [note for note in demand_rows(checked, own, "the hold-out") if note.kind in OTHER_ROWS]
    return tuple(replace(note, said=f"in {', '.join(names)} {note.said}") for note in notes)


def _explained(seen: Seen) -> tuple[Seen, Search | None]:
    """What explains the gap, with axes that yield near rest where that is part of it; no search where no gap is left then.

    They are asked beside single effects first, as a rig that yields is searched in vain by a plant that sticks. What a second effect would
    explain often looks like yielding there: what is then found must still need them.
    """
    begun = alone_of(seen)
    seen, again = _yielding(seen, begun.best(decisions.NEXT))
    if again is not None:
        further = _searched(again)
        if needed(seen.case, again.retuned if further is None else further.fitted[0]):
            return again, further
    found = search(seen.case, seen.case.library.candidates, begun)
    seen, again = _yielding(seen, found.fitted[: decisions.NEXT])
    if again is None:
        return seen, found
    further = _searched(again)
    best = again.retuned if further is None else further.fitted[0]
    return (again, further) if best.evidence > found.fitted[0].evidence else (seen, found)


def _yielding(seen: Seen, found: Sequence[FittedHypothesis]) -> tuple[Seen, Seen | None]:
    """The same with the rules asked, and all anew with axes that yield near rest, where that explains the logs better beside one of those
    found; else None."""
    there = yielding(seen.case, list(found) if seen.retuned in found else [*found, seen.retuned])
    is_anew, rules = changes_names(there, found[0], seen.retuned)
    seen = seen.because(*there.decisions, *rules)
    return seen, beside_noise(_anew(seen, there)) if is_anew else None


def _anew(seen: Seen, there: Yielding) -> Seen:
    """What is seen where those axes yield, after what was."""
    anew = detected_anew(there.case, seen, there.beside)
    return replace(anew, decisions=(*seen.decisions, *anew.decisions))


def _searched(seen: Seen) -> Search | None:
    """What is found; None where there is no gap."""
    if not alarmed(seen.detection.p):
        return None
    return search(seen.case, seen.case.library.candidates, alone_of(seen))


@dataclass(frozen=True, eq=False)
class _Found:
    """What may explain a gap: names, with the nats that are `left` beside the best of them, the plant's parameters beyond their spread, a
    free curve."""

    search: Search
    left: float
    beyond: Retune | None = None
    curve: FittedCurve | None = None


def _judged(seen: Seen, material: Material, found: _Found) -> tuple[Seen, Judged]:
    """Weigh what was found, and check it on the hold-out."""
    logs = FittedLogs(seen.case)
    found = replace(found, curve=curve_that_predicts(logs, found.curve, seen.retuned.fit.hypothesis))
    ranked = _ranked(seen, material, found, logs)
    first = ranked.weighed.fitted[0] if ranked.weighed.fitted else None
    wider = found.search if first is None else with_twins(seen.case, found.search, first)
    if wider is not found.search:
        same = _best(wider) is _best(found.search)
        found = replace(found, search=wider, left=found.left if same else _left(seen.case, wider))
        ranked = _ranked(seen, material, found, logs, ranked.holdout)
    seen, weighed, holdout, retuned = ranked.seen, ranked.weighed, ranked.holdout, seen.retuned
    doubts = doubt(seen.case, found.search, weighed, material.names)
    weighed, notes = doubts.applied(weighed), (*material.notes, *doubts.notes, *ranked.notes)
    share = first_share(seen.case, weighed)
    chosen, named_rules = chosen_of(weighed, retuned, None if found.beyond is None else found.beyond.fitted, share)
    seen = seen.because(*doubts.decisions, *named_rules)
    if holdout is not None and chosen is retuned:
        chosen = holdout.base
    elif holdout is not None:
        chosen, told, rules = added(holdout, chosen, share if chosen.effects else 1.0)
        seen, notes = seen.because(*rules), (*notes, *told)
    return seen, Judged(found.search, found.beyond, found.curve, weighed, chosen, holdout, notes)


@dataclass(frozen=True, eq=False)
class _Ranked:
    """What was found by what the logs and the hold-out say of it, the hold-out, and what is to be told of it."""

    seen: Seen
    weighed: Weighed
    holdout: Holdout | None
    notes: tuple[Note, ...] = ()


def _ranked(seen: Seen, material: Material, found: _Found, logs: FittedLogs, known: Holdout | None = None) -> _Ranked:
    """What was found, ranked; `known` is a hold-out that was made before.

    What predicts better is asked of all logs, whether a gap matters of those to explain alone: no further log makes a gap none.
    """
    explanations = _explanations(seen, found)
    fitted_ahead = foreseen(logs, explanations)
    weighed = weigh(without_idle(explanations, shares_of(explanations, fitted_ahead, logs, None))[0], fitted_ahead)
    matters_nats = weighed.ahead_nats
    seen, holdout = _checked(seen, material, weighed.fitted[0].effects if weighed.fitted else (), known)
    ahead = fitted_ahead if holdout is None else with_held_out(fitted_ahead, holdout)
    explanations = (
        explanations if holdout is None else replace(explanations, curve=curve_with_held_out(found.curve, holdout))
    )
    explanations, idle = without_idle(explanations, shares_of(explanations, ahead, logs, holdout))
    weighed = replace(weigh(explanations, ahead), ahead_nats=matters_nats)
    seen = seen.because(*found.search.decisions, *idle, *foreseen_rules(ahead, weighed))
    first = _likeliest(weighed, found.beyond)
    if holdout is None or first is None:
        return _Ranked(seen.because(*weighed.decisions), weighed, holdout)
    told, notes, rules = asked(holdout, first)
    weighed = replace(weigh(explanations, ahead, favour(told)), ahead_nats=matters_nats)
    return _Ranked(seen.because(*rules, *weighed.decisions), weighed, holdout, notes)


def _likeliest(weighed: Weighed, beyond: Retune | None) -> FittedHypothesis | None:
    """What logs that were not fitted are asked of: the likeliest of what explains, be it the plant's own parameters."""
    if beyond is not None and weighed.retune > max(weighed.probabilities, default=0.0):
        return beyond.fitted
    return weighed.fitted[0] if weighed.fitted else None


def _explanations(seen: Seen, found: _Found) -> Explanations:
    """All that may explain the gap; what swings beside noise is a form of its own."""
    beyond, named = found.beyond, tuple(entry for entry in found.search.fitted if entry.effects)
    alone, nats = (None, None) if beyond is None else (beyond.fitted, beyond.score)
    return Explanations(named, seen.retuned, seen.case.library, found.left, alone, nats, found.curve)


def _best(found: Search) -> FittedHypothesis:
    """The best of what was found, with effects where any has some."""
    return found.fitted[0] if found.fitted[0].effects else found.fitted[-1]


def _left(case: Case, found: Search) -> float:
    """What forms still gain beside the best of what was found, in nats."""
    best = _best(found)
    return left_beside(form_scores(linearised(case, best.fit)), [case.library.effects[name] for name in best.effects])


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


__all__ = ["Material", "diagnose"]
