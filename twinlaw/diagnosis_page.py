"""The report of `twinlaw diagnose`: verdict, guilty block, shrinkage, maps, causes, what else it could be, and what to record next."""

from collections.abc import Mapping, Sequence

from diagnosis.curve import Shape
from diagnosis.notes import HIDDEN, UNSEEN
from records.diagnosis import Diagnosis, Hypothesis
from sim.places import Places
from twinlaw.block_diagram import block_diagram
from twinlaw.diagnosis_pictures import Predicted, curves, maps, shape_section
from twinlaw.diagnosis_shrinkage import shrinkage_sections
from twinlaw.diagnosis_words import chance, listed, percent, plain_text, words
from twinlaw.page import Page, Section, Table

ALWAYS, SELDOM = 3, 0.01  # the first few causes are always shown, further ones from this probability
LIKELY = 0.8  # below which a name is no more than the likeliest of several
MOVED = " standard deviations from its stated value: "  # in a note about a parameter

__all__ = ["Predicted", "diagnosis_page", "verdict_sentence"]


def diagnosis_page(
    plant: str,
    diagnosis: Diagnosis,
    places: Places,
    stories: Mapping[str, str],
    predicted: Sequence[Predicted],
    logs: Sequence[str],
    shape: Shape | None = None,
) -> Page:
    """The whole page; `stories` gives one plain sentence for each effect, `logs` the names of the files that were diagnosed, `shape` the
    curve of an effect without a name."""
    sections: list[Section | None] = [_place(diagnosis, places), _causes(diagnosis, stories)]
    if shape is not None:
        sections.append(shape_section(shape, words(diagnosis.unknown.place or "rig"), diagnosis.unknown.form))
    sections.append(_next(diagnosis))
    if diagnosis.shrinkage is not None:
        sections += shrinkage_sections(diagnosis.shrinkage, bool(diagnosis.found))
    sections += [curves(log) for log in predicted]
    sections += [maps(diagnosis), _firmware(diagnosis), _unseen(diagnosis), _notes(diagnosis)]
    return Page(
        title=f"{plant}: where the model and the rig part",
        verdict=verdict_sentence(diagnosis),
        passed=diagnosis.verdict == "no gap",
        facts=(("Logs", ", ".join(logs)),),
        sections=tuple(section for section in sections if section is not None),
    )


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """What was found, in one sentence for a reader who knows nothing but the rig."""
    if diagnosis.verdict == "no gap":
        return "The plant file explains these logs: nothing is missing that they could show."
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
    retuned = _parameters_alone(diagnosis)
    moved = [note.partition(" is ")[0].removeprefix("parameter ") for note in diagnosis.notes if MOVED in note]
    if moved and retuned > max(unknown.probability, first.probability if first else 0.0):
        return f"The rig has other parameters than the plant file states, and nothing else is missing: {listed(moved)}."
    where = f" in {words(unknown.place)}" if unknown.place else ""
    if first is not None and first.probability > unknown.probability:
        return (
            f"The rig does something{where} that the plant file lacks, most likely {words(first.effect)} "
            f"({percent(first.probability)}); but that predicts the hold-out logs no better, so it was not added."
        )
    return f"The rig does something{where} that the plant file lacks, and no effect of the library can be named for it."


def _parameters_alone(diagnosis: Diagnosis) -> float:
    """The probability that other parameters explain the gap and nothing is missing."""
    return 1.0 - diagnosis.unknown.probability - sum(h.probability for h in diagnosis.effects)


def _place(diagnosis: Diagnosis, places: Places) -> Section:
    gap = diagnosis.verdict == "gap"
    shares = {entry.place: entry.share for entry in diagnosis.places} if gap else {}
    p = diagnosis.false_alarm_probability
    alarm = (
        ""
        if p is None
        else f"A rig that is as the plant file states, with its sensors, shows so large a gap with probability {chance(p)}."
    )
    lit = "The rig as blocks, from the commands on the left to the sensors on the right"
    lit += "; the warmer a block, the more of the gap lies there." if shares else "."
    return Section(
        "Where it lies" if gap else "The rig", tuple(filter(None, (lit, alarm))), plots=(block_diagram(places, shares),)
    )


def _causes(diagnosis: Diagnosis, stories: Mapping[str, str]) -> Section | None:
    if not diagnosis.effects and not diagnosis.unknown.probability:
        return None
    told = [f"{words(name).capitalize()}: {stories[name]}" for name in diagnosis.found if name in stories]
    told += [
        f"These data cannot tell {words(h.effect)} from {listed([words(name) for name in h.ambiguous_with])}."
        for h in diagnosis.effects[:1]
        if h.ambiguous_with and diagnosis.found
    ]
    unknown, retuned = diagnosis.unknown, _parameters_alone(diagnosis)
    likeliest = max([retuned, *(h.probability for h in diagnosis.effects)])
    if unknown.class_ and not diagnosis.found and unknown.probability > likeliest:
        where = f" {words(unknown.place)}" if unknown.place else ""
        told.append(
            f"What is missing acts on{where} and is of the form {unknown.class_}; no effect of the library fits it."
        )
    rows = [
        _cause_row(h, set(h.effect.split(" + ")) == set(diagnosis.found))
        for place, h in enumerate(diagnosis.effects)
        if place < ALWAYS or h.probability > SELDOM
    ]
    if retuned > SELDOM:
        rows.append(("other parameters alone", "see the notes", percent(retuned), "", ""))
    rows.append(("none of the library", unknown.class_ or "", percent(unknown.probability), "", ""))
    return Section(
        "What causes it",
        told,
        (Table(rows, ("effect", "depends on, acts on", "probability", "size", "looks the same")),),
    )


def _cause_row(hypothesis: Hypothesis, found: bool) -> tuple[str, ...]:
    size = ", ".join(
        f"{name} = {e.value:.4g} ± {e.sd:.1g} {e.unit if e.unit != '-' else ''}".strip()
        for name, e in hypothesis.parameters.items()
    )
    name = hypothesis.effect + (" (found)" if found else "")
    return name, hypothesis.class_, percent(hypothesis.probability), size, listed(hypothesis.ambiguous_with)


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


def _firmware(diagnosis: Diagnosis) -> Section | None:
    firmware = diagnosis.firmware
    if firmware is None:
        return None
    again = "Run again on the logged measurements, the controller's own code"
    if not firmware.replayed:
        sentence = (
            f"The controller's code could not be run again on the logs: {firmware.cause or 'its table is not at hand'}."
        )
    elif firmware.bit_exact:
        sentence = f"{again} gives every logged input to the bit: the firmware is cleared."
    else:
        cause = firmware.cause or "cause not found"
        sentence = f"{again} first differs at {firmware.first_difference_s:g} s: {cause}."
    return Section("Firmware", (sentence,))


def _unseen(diagnosis: Diagnosis) -> Section | None:
    """What the notes say of effects that hide in these logs, by place."""
    rows = [_parts(note) for note in diagnosis.notes if note.startswith(UNSEEN)]
    if not rows:
        return None
    told = [f"{note}." for note in diagnosis.notes if HIDDEN in note]
    told.append("At each place, what may be there and would not have shown, and below which size; the largest first.")
    return Section("What these logs could not have shown", told, (Table(rows, ("place", "effects")),))


def _parts(note: str) -> tuple[str, str]:
    place, _, effects = note.removeprefix(f"{UNSEEN} at the ").partition(": ")
    return place.replace("_", " "), effects.replace("_", " ")


def _notes(diagnosis: Diagnosis) -> Section | None:
    others = [note for note in diagnosis.notes if not note.startswith(UNSEEN) and HIDDEN not in note]
    return Section("Notes", others) if others else None
