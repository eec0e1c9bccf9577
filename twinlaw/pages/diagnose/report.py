"""The report of `twinlaw diagnose`: verdict, guilty block, shrinkage, maps, causes, what else it could be, and what to record next."""

from collections.abc import Sequence

from diagnosis.explain.curve import Shape
from diagnosis.explain.sentences import sentence, unseen_effects
from records.diagnosis import Diagnosis
from sim.added_effects import library
from sim.bind import BoundPlant
from sim.model import Model
from twinlaw.pages.block_diagram import block_diagram
from twinlaw.pages.diagnose.answers import answers_section
from twinlaw.pages.diagnose.causes import causes_section
from twinlaw.pages.diagnose.firmware import beside_firmware, firmware_in_words
from twinlaw.pages.diagnose.pictures import Predicted, curves, maps, shape_section
from twinlaw.pages.diagnose.quality import diagnosis_quality
from twinlaw.pages.diagnose.retune import Moved, retuned_sentence
from twinlaw.pages.diagnose.shrinkage import shrinkage_sections
from twinlaw.pages.diagnose.verdict import verdict_sentence
from twinlaw.pages.diagnose.why import why_section
from twinlaw.pages.diagnose.words import alarm_in_words, plain_notes, plain_text, words
from twinlaw.pages.page import Page, Section, Table, as_sentence
from twinlaw.pages.quality import quality_section, quality_sentence

UNSEEN, HIDDEN = "unseen", "hidden"  # kinds of notes


def diagnosis_page(
    bound: BoundPlant,
    diagnosis: Diagnosis,
    predicted: Sequence[Predicted],
    logs: Sequence[str],
    shape: Shape | None = None,
    moved: Sequence[Moved] = (),
) -> Page:
    """The whole page; `logs` are the names of the files that were diagnosed, `shape` the curve of an effect without a name, `moved` the
    plant's own numbers that moved most."""
    firmware = Section("Firmware", (firmware_in_words(diagnosis.firmware, diagnosis.note_records),))
    amiss = diagnosis.firmware is not None and diagnosis.firmware.differs
    quality = diagnosis_quality(diagnosis)
    sections: list[Section | None] = [firmware] if amiss else []
    sections += [_place(diagnosis, bound.model), causes_section(diagnosis, library(bound), moved)]
    if shape is not None:
        sections.append(shape_section(shape, words(diagnosis.unknown.place or "rig"), diagnosis.unknown.form))
    sections.append(_next(diagnosis))
    retuned = retuned_sentence(diagnosis, moved)
    if diagnosis.shrinkage is not None:
        sections += shrinkage_sections(diagnosis.shrinkage, bool(diagnosis.found), retuned)
    elif retuned:
        sections.append(Section("What re-tuning moved", (retuned,)))
    sections += [curves(log) for log in predicted]
    sections += [
        maps(diagnosis),
        answers_section(diagnosis),
        None if amiss else firmware,
        _unseen(diagnosis),
        why_section(diagnosis),
        _notes(diagnosis),
        quality_section(quality),
    ]
    return Page(
        title=f"{bound.plant.name}: where the model and the rig part",
        verdict=verdict_sentence(diagnosis),
        colour=quality.colour,
        why=quality_sentence(quality),
        facts=(("Logs", ", ".join(logs)),),
        sections=tuple(section for section in sections if section is not None),
    )


def _place(diagnosis: Diagnosis, model: Model) -> Section:
    gap = diagnosis.verdict == "gap"
    shares = {entry.place: entry.share for entry in diagnosis.places} if gap else {}
    p = diagnosis.false_alarm_probability
    told = "" if p is None else alarm_in_words(diagnosis, p)
    alarm = f"{told[:1].upper()}{told[1:]}." if told else ""
    lit = "The rig as blocks, from the commands on the left to the sensors on the right"
    lit += "; the warmer and darker a block, the more of the gap lies there." if shares else "."
    return Section(
        "Where it lies" if gap else "The rig", tuple(filter(None, (lit, alarm))), plots=(block_diagram(model, shares),)
    )


def _next(diagnosis: Diagnosis) -> Section | None:
    told = diagnosis.next_experiment
    if not told:
        return None
    if not {"experiment", "instruction", "expected_outcome"} <= set(told):
        return Section("What to record next", (), (Table([(name, plain_text(value)) for name, value in told.items()]),))
    split, alike = told.get("separates") or (), told.get("does_not_separate") or ()
    sentences = [
        f"{str(told['experiment']).capitalize()}: {told['instruction']}.",
        f"{'Expected' if split else 'Why'}: {told['expected_outcome']}.",
    ]
    if split:
        sentences.append(f"It tells {plain_text(split)}.")
    if split and alike:
        sentences.append(f"It does not tell {plain_text(alike)}.")
    return Section("What to record next", sentences)


def _unseen(diagnosis: Diagnosis) -> Section | None:
    """What the notes say of effects that hide in these logs, by place."""
    notes = diagnosis.note_records
    rows = [
        (note.subject.replace("_", " "), unseen_effects(note, lambda kind: kind.replace("_", " ")))
        for note in notes
        if note.kind == UNSEEN
    ]
    if not rows:
        return None
    told = [f"{sentence(note)}." for note in notes if note.kind == HIDDEN]
    told.append("At each place, what may be there and would not have shown, and below which size; the largest first.")
    return Section("What these logs could not have shown", told, (Table(rows, ("place", "effects")),))


def _notes(diagnosis: Diagnosis) -> Section | None:
    notes = beside_firmware(diagnosis.firmware, diagnosis.note_records)
    others = plain_notes([note for note in notes if note.kind not in (UNSEEN, HIDDEN)])
    return Section("Notes", [as_sentence(note) for note in others]) if others else None
