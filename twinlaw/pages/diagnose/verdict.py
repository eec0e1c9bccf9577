"""The verdict of a diagnosis in words for a reader who knows nothing but the rig."""

from records.diagnosis import Diagnosis
from twinlaw.pages.diagnose.firmware import firmware_first
from twinlaw.pages.diagnose.retune import lowered, parameters_alone
from twinlaw.pages.diagnose.why import SMALL, reason_in_words
from twinlaw.pages.diagnose.words import listed, percent, words

LIKELY = 0.8  # below which a name is no more than the likeliest of several
MOVED = "moved_parameter"  # kind of note


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """What was found for a reader who knows nothing but the rig: first what the firmware did otherwise, then one sentence on the plant."""
    return f"{firmware_first(diagnosis.firmware)} {_plant_sentence(diagnosis)}".strip()


def _plant_sentence(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == "no gap" and diagnosis.verdict_reason in SMALL:
        return f"No gap is told. {reason_in_words(diagnosis)}"
    if diagnosis.verdict == "no gap":
        tuned = " once its parameters are re-tuned within what it states of them" if lowered(diagnosis) else ""
        return f"The plant file explains these logs{tuned}: nothing is missing that they could show."
    if diagnosis.verdict == "cannot tell":
        return "These logs hold too little motion to tell whether the plant file lacks anything."
    if not diagnosis.found:
        return _nothing_added(diagnosis)
    names = " and ".join(words(name) for name in diagnosis.found)
    named = [h.probability for h in diagnosis.effects if set(h.effect.split(" + ")) == set(diagnosis.found)]
    sure = f" ({percent(named[0])} sure)" if named else ""
    likely = "most likely " if named and named[0] < LIKELY else ""
    gone = diagnosis.shrinkage.fraction if diagnosis.shrinkage else None
    gain = (
        ""
        if gone is None
        else f", and with it in the model {percent(gone)} of the removable error on the hold-out logs is gone"
    )
    return f"The rig has what the plant file lacks: {likely}{names}{sure}{gain}."


def _nothing_added(diagnosis: Diagnosis) -> str:
    """The verdict on a gap for which no effect was added: other parameters, an effect that did not help, or none that fits."""
    unknown, first = diagnosis.unknown, diagnosis.effects[0] if diagnosis.effects else None
    retuned = parameters_alone(diagnosis)
    moved = [note.subject for note in diagnosis.note_records if note.kind == MOVED]
    if moved and retuned > max(unknown.probability, first.probability if first else 0.0):
        return f"The rig has other parameters than the plant file states, and nothing else is missing: {listed(moved)}."
    where = f" in {words(unknown.place)}" if unknown.place else ""
    if first is not None and first.probability > unknown.probability:
        return (
            f"The rig does something{where} that the plant file lacks, most likely {words(first.effect)} "
            f"({percent(first.probability)}); but that predicts the hold-out logs surely worse, so it was not added."
        )
    return f"The rig does something{where} that the plant file lacks, and no effect of the library can be named for it."
