"""The colour of a diagnosis: how well the plant that it hands on predicts, and what it leaves open."""

from records.diagnosis import Diagnosis
from records.quality import MISFIT, Colour, Look, Quality, flag
from records.reasons import DOUBTS, THINNED
from twinlaw.pages.diagnose.firmware import amiss
from twinlaw.pages.diagnose.retune import parameters_alone
from twinlaw.pages.diagnose.words import misfits, words


def diagnosis_quality(diagnosis: Diagnosis) -> Quality:
    """Errors on the logs held out against what their sensors leave, and a flag for a gap, for what cannot be told, for the firmware."""
    flags = [_verdict(diagnosis)]
    if amiss(diagnosis.firmware):
        flags.append(flag(amiss(diagnosis.firmware), Colour.RED))
    doubts = {note.kind for note in diagnosis.note_records} & set(DOUBTS)
    if THINNED in doubts:
        flags.append(flag("rows of which one in so many was written"))
    if doubts - {THINNED}:
        flags.append(flag("columns that may be others than they are called"))
    looks = [MISFIT.look(f"{name} on the logs held out", misfit) for name, misfit in misfits(diagnosis).items()]
    return Quality((*looks, *(entry for entry in flags if entry is not None)))


def _verdict(diagnosis: Diagnosis) -> Look | None:
    if diagnosis.verdict == "no gap":
        return flag("no gap", Colour.GREEN)
    if diagnosis.verdict == "cannot tell":
        unsure = diagnosis.verdict_reason == "too_unsure"
        return flag("a gap that these logs do not show surely" if unsure else "too little motion to tell a gap")
    if diagnosis.found:
        return flag(f"the plant file lacks {' and '.join(map(words, diagnosis.found))}")
    if parameters_alone(diagnosis) > max(
        diagnosis.unknown.probability, *(h.probability for h in diagnosis.effects), 0.0
    ):
        return flag("the plant file's parameters are not the rig's")
    return flag("the plant file lacks something that has no name", Colour.RED)
