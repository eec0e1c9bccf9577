"""The verdict of a diagnosis in words for a reader who knows nothing but the rig."""

from collections.abc import Sequence

from records.diagnosis import Diagnosis, RankedHypothesis
from records.reasons import Note
from records.text.uncertain import to_sd
from records.text.units import plain_unit
from twinlaw.pages.diagnose.firmware import firmware_first
from twinlaw.pages.diagnose.retune import lowered, parameters_alone
from twinlaw.pages.diagnose.why import SMALL, reason_in_words
from twinlaw.pages.diagnose.words import (
    dependence_in_words,
    doubts_in_words,
    listed,
    missed_most,
    percent,
    window,
    words,
)
from twinlaw.pages.page import as_sentence

LIKELY = 0.8  # below which a name is no more than the likeliest of several
LEAST_GONE = 0.01  # share of the error below which its going is not told
WORTH_A_THOUGHT = 0.05  # from which the next best is told
MOVED = ("moved_parameter", "moved_effect")  # kinds of notes
_NOT_TOLD = {"no gap": "No gap is told", "cannot tell": "Whether the plant file lacks anything cannot be told"}


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """What was found for a reader who knows nothing but the rig: first what makes it doubtful and what the firmware did otherwise, then one
    sentence on the plant."""
    doubts = doubts_in_words(diagnosis.note_records)
    first = as_sentence(doubts) if doubts else ""
    return " ".join(filter(None, (first, firmware_first(diagnosis.firmware), _plant_sentence(diagnosis))))


def _plant_sentence(diagnosis: Diagnosis) -> str:
    missed = missed_most(diagnosis)
    if diagnosis.verdict != "gap" and diagnosis.verdict_reason in SMALL:
        rest = (
            ""
            if missed is None
            else f" The rest is noise to the model: predictions over {window(diagnosis)} miss {missed}."
        )
        return f"{_NOT_TOLD[diagnosis.verdict]}. {reason_in_words(diagnosis)}{rest}"
    if diagnosis.verdict == "no gap":
        tuned = " once its parameters are re-tuned within what it states of them" if lowered(diagnosis) else ""
        if missed is None:
            return f"The plant file explains these logs{tuned}: nothing is missing that they could show."
        yet = f"nothing that they could show is missing, yet predictions over {window(diagnosis)} miss {missed}"
        return f"The plant file explains these logs{tuned}, noise apart: {yet}."
    if diagnosis.verdict == "cannot tell":
        return "These logs hold too little motion to tell whether the plant file lacks anything."
    if not diagnosis.found:
        return _nothing_added(diagnosis)
    chosen = [h for h in diagnosis.effects if set(h.names) == set(diagnosis.found)]
    sizes = _sizes(chosen[0]) if chosen else {}
    names = " and ".join(words(name) + sizes.get(name, "") for name in diagnosis.found)
    part = f", {percent(diagnosis.partly)} that a part of it is right" if diagnosis.partly > WORTH_A_THOUGHT else ""
    sure = f" ({percent(chosen[0].probability)} sure{part})" if chosen else ""
    likely = "most likely " if chosen and chosen[0].probability < LIKELY else ""
    gone = diagnosis.shrinkage.fraction if diagnosis.shrinkage else None
    gain = (
        ""
        if gone is None or gone < LEAST_GONE
        else f", and with it in the model {percent(gone)} of the removable error on the hold-out logs is gone"
    )
    return f"The rig has what the plant file lacks: {likely}{names}{sure}{gain}.{_rival(diagnosis, chosen)}"


def _sizes(hypothesis: RankedHypothesis) -> dict[str, str]:
    """The first number of each effect, which is its size, with its unit."""
    found: dict[str, str] = {}
    several = len(hypothesis.names) > 1
    for symbol, entry in hypothesis.parameters.items():
        name = symbol.rpartition(".")[0] if several else hypothesis.effect
        told = f"{symbol.rpartition('.')[2]} = {to_sd(entry.value, entry.sd)} {plain_unit(entry.unit)}".rstrip()
        found.setdefault(name, f" with {told}")
    return found


def _rival(diagnosis: Diagnosis, chosen: Sequence[RankedHypothesis]) -> str:
    """The next best explanation, where it is worth a thought, and the run that would tell it from what was found."""
    others = [(h.probability, words(h.effect)) for h in diagnosis.effects if h not in chosen]
    others.append((diagnosis.unknown.probability, "an effect that has no name here"))
    probability, name = max(others)
    if probability < WORTH_A_THOUGHT:
        return ""
    run = diagnosis.next_experiment or {}
    tells = f"; to tell them apart, {run['instruction']}" if run.get("separates") and "instruction" in run else ""
    return f" Next comes {name} ({percent(probability)}){tells}."


def _moved(note: Note) -> str:
    """ "J_A = 0.005 (the file states 0.004)"."""
    symbol, numbers = note.numbers.get("symbol"), note.numbers
    name = note.subject if symbol is None else f"{symbol} of the {words(note.subject)}"
    return f"{name} = {numbers['value']:.4g} (the file states {numbers['stated']:.4g})"


def _nothing_added(diagnosis: Diagnosis) -> str:
    """The verdict on a gap for which no effect was added: other parameters, an effect that did not help, or none that fits."""
    unknown, first = diagnosis.unknown, diagnosis.effects[0] if diagnosis.effects else None
    retuned = parameters_alone(diagnosis)
    moved = [_moved(note) for note in diagnosis.note_records if note.kind in MOVED]
    if moved and retuned > max(unknown.probability, first.probability if first else 0.0):
        return f"The rig has other parameters than the plant file states, and nothing else is missing: {listed(moved)}."
    where = f" in {words(unknown.place)}" if unknown.place else ""
    if first is not None and first.probability + diagnosis.partly > unknown.probability:
        return (
            f"The rig does something{where} that the plant file lacks, most likely {words(first.effect)} "
            f"({percent(first.probability)}); but with that the hold-out logs are not predicted better, so it was not added."
        )
    what = dependence_in_words(unknown.class_) if unknown.class_ else ""
    found = f"something{where} that the plant file lacks{f', {what}' if what else ''}"
    return f"The rig does {found}; no effect of the library can be named for it."
