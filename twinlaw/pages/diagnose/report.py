"""The report of `twinlaw diagnose`: verdict, guilty block, shrinkage, maps, causes, what else it could be, and what to record next."""

from collections.abc import Mapping, Sequence

from diagnosis.explain.curve import Shape
from diagnosis.explain.sentences import sentence, unseen_effects
from records.diagnosis import Diagnosis, Hypothesis
from sim.places import Places
from twinlaw.pages.block_diagram import block_diagram
from twinlaw.pages.diagnose.answers import answers_section
from twinlaw.pages.diagnose.firmware import differs, firmware_first, firmware_in_words
from twinlaw.pages.diagnose.pictures import Predicted, curves, maps, shape_section
from twinlaw.pages.diagnose.retune import Moved, lowered, moved_in_words, parameters_alone
from twinlaw.pages.diagnose.shrinkage import shrinkage_sections
from twinlaw.pages.diagnose.why import SMALL, reason_in_words, why_section
from twinlaw.pages.diagnose.words import (
    alarm_in_words,
    class_in_words,
    listed,
    percent,
    plain_notes,
    plain_text,
    shown,
    sized,
    words,
)
from twinlaw.pages.page import Page, Section, Table

ALWAYS, SELDOM = 3, 0.01  # the first few causes are always shown, further ones from this probability
LIKELY = 0.8  # below which a name is no more than the likeliest of several
UNSEEN, HIDDEN, MOVED = "unseen", "hidden", "moved_parameter"  # kinds of notes

__all__ = ["Predicted", "diagnosis_page", "verdict_sentence"]


def diagnosis_page(
    plant: str,
    diagnosis: Diagnosis,
    places: Places,
    stories: Mapping[str, str],
    predicted: Sequence[Predicted],
    logs: Sequence[str],
    shape: Shape | None = None,
    moved: Sequence[Moved] = (),
    widths: Mapping[str, float] = {},
) -> Page:
    """The whole page; `stories` gives one plain sentence for each effect, `logs` the names of the files that were diagnosed, `shape` the
    curve of an effect without a name, `moved` the plant's own numbers that moved most, `widths` see `sized`."""
    firmware = Section("Firmware", (firmware_in_words(diagnosis.firmware),))
    amiss = differs(diagnosis.firmware)
    sections: list[Section | None] = [firmware] if amiss else []
    sections += [_place(diagnosis, places), _causes(diagnosis, stories, moved, widths)]
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
    ]
    return Page(
        title=f"{plant}: where the model and the rig part",
        verdict=verdict_sentence(diagnosis),
        passed=diagnosis.verdict == "no gap" and not amiss,
        facts=(("Logs", ", ".join(logs)),),
        sections=tuple(section for section in sections if section is not None),
    )


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
            f"({percent(first.probability)}); but that predicts the hold-out logs no better, so it was not added."
        )
    return f"The rig does something{where} that the plant file lacks, and no effect of the library can be named for it."


def retuned_sentence(diagnosis: Diagnosis, moved: Sequence[Moved]) -> str:
    """How much re-tuning alone lowers the hold-out error, and which numbers moved; empty where neither is worth a sentence."""
    parts = []
    for output, (stated, now) in lowered(diagnosis).items():
        name, unit, scale = shown(output)
        parts.append(f"{name} from {scale * stated:.3g} to {scale * now:.3g} {unit.strip('[]')}".strip())
    told = f"Re-tuning alone lowers the error of {', of '.join(parts)}. " if parts else ""
    beside = " beside what was found" if diagnosis.found else ""
    if moved:
        told += f"What moved most{beside}, in standard deviations (sd) of what the plant file states: {moved_in_words(moved)}."
    return told.strip()


def _place(diagnosis: Diagnosis, places: Places) -> Section:
    gap = diagnosis.verdict == "gap"
    shares = {entry.place: entry.share for entry in diagnosis.places} if gap else {}
    p = diagnosis.false_alarm_probability
    told = "" if p is None else alarm_in_words(diagnosis, p)
    alarm = f"{told[:1].upper()}{told[1:]}." if told else ""
    lit = "The rig as blocks, from the commands on the left to the sensors on the right"
    lit += "; the warmer a block, the more of the gap lies there." if shares else "."
    return Section(
        "Where it lies" if gap else "The rig", tuple(filter(None, (lit, alarm))), plots=(block_diagram(places, shares),)
    )


def _causes(
    diagnosis: Diagnosis, stories: Mapping[str, str], moved: Sequence[Moved], widths: Mapping[str, float]
) -> Section | None:
    if not diagnosis.effects and not diagnosis.unknown.probability:
        return None
    told = [f"{words(name).capitalize()}: {stories[name]}" for name in diagnosis.found if name in stories]
    told += [
        f"These data cannot tell {words(h.effect)} from {listed([words(name) for name in h.ambiguous_with])}."
        for h in diagnosis.effects[:1]
        if h.ambiguous_with and diagnosis.found
    ]
    unknown, retuned = diagnosis.unknown, parameters_alone(diagnosis)
    likeliest = max([retuned, *(h.probability for h in diagnosis.effects)])
    if unknown.class_ and not diagnosis.found and unknown.probability > likeliest:
        where = f" {words(unknown.place)}" if unknown.place else ""
        told.append(
            f"What is missing acts on{where} and is of the form {class_in_words(unknown.class_)}; no effect of the library fits it."
        )
    shown_ones = [h for place, h in enumerate(diagnosis.effects) if place < ALWAYS or h.probability > SELDOM]
    ranked = [
        (h.probability, _cause_rows(h, set(h.effect.split(" + ")) == set(diagnosis.found), widths)) for h in shown_ones
    ]
    if retuned > SELDOM:
        # Beside an effect other numbers move than without it.
        own = "" if diagnosis.found else moved_in_words(moved)
        ranked.append((retuned, [("other parameters alone", "", percent(retuned), own, "")]))
    ranked.sort(key=lambda entry: -entry[0])
    rows = [row for _, lines in ranked for row in lines]
    class_ = class_in_words(unknown.class_ or "")
    rows.append(("none of the library", class_, percent(unknown.probability), "", ""))
    return Section(
        "What causes it",
        told,
        (Table(rows, ("effect", "depends on, acts on", "probability", "size", "looks the same")),),
    )


def _cause_rows(hypothesis: Hypothesis, found: bool, widths: Mapping[str, float]) -> list[tuple[str, ...]]:
    """A row for each effect, those that it is joint with below the first."""
    rows: list[tuple[str, ...]] = []
    for place, (name, class_, size) in enumerate(sized(hypothesis, widths)):
        first = place == 0
        rows.append(
            (
                ("" if first else "with ") + name + (" (found)" if found else ""),
                class_in_words(class_),
                percent(hypothesis.probability) if first else "",
                size,
                listed(hypothesis.ambiguous_with) if first else "",
            )
        )
    return rows


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
        (note.subject.replace("_", " "), unseen_effects(note).replace("_", " "))
        for note in notes
        if note.kind == UNSEEN
    ]
    if not rows:
        return None
    told = [f"{sentence(note)}." for note in notes if note.kind == HIDDEN]
    told.append("At each place, what may be there and would not have shown, and below which size; the largest first.")
    return Section("What these logs could not have shown", told, (Table(rows, ("place", "effects")),))


def _notes(diagnosis: Diagnosis) -> Section | None:
    others = plain_notes([note for note in diagnosis.note_records if note.kind not in (UNSEEN, HIDDEN)])
    return Section("Notes", others) if others else None
