"""A diagnosis in a few lines for a terminal."""

from collections.abc import Iterator, Mapping, Sequence

from records.diagnosis import Diagnosis
from sim.effect import Effect
from twinlaw.cli import console
from twinlaw.pages.diagnose.answers import surest_answer
from twinlaw.pages.diagnose.firmware import beside_firmware, firmware_behind_the_first
from twinlaw.pages.diagnose.quality import diagnosis_quality
from twinlaw.pages.diagnose.retune import Moved, lowered, moved_in_words, parameters_alone
from twinlaw.pages.diagnose.verdict import verdict_sentence
from twinlaw.pages.diagnose.words import (
    alarm_in_words,
    chance,
    class_in_words,
    plain_notes,
    shown,
    sized,
)
from twinlaw.pages.quality import quality_sentence

MOST_TOLD = 5


def summary_text(diagnosis: Diagnosis, moved: Sequence[Moved] = (), effects: Mapping[str, Effect] = {}) -> str:
    """The verdict in a sentence, ranked effects, places, shrinkage, firmware, notes; `moved` are the plant's own numbers that moved
    most, `effects` the plant's library by name."""
    return "\n".join(_lines(diagnosis, moved, effects)) + "\n"


def _lines(diagnosis: Diagnosis, moved: Sequence[Moved], effects: Mapping[str, Effect]) -> Iterator[str]:
    yield verdict_sentence(diagnosis)
    p = diagnosis.false_alarm_probability
    if p is None:
        yield diagnosis.verdict
    elif diagnosis.verdict == "gap":
        yield f"gap (chance of so large a gap without one: {chance(p)})"
    else:
        yield f"{diagnosis.verdict}: {alarm_in_words(diagnosis, p)}"
    if diagnosis.verdict == "gap":
        yield console.table(_rows(diagnosis, moved, effects))
    if diagnosis.unknown.form:
        yield f"sparse regression suggests: {diagnosis.unknown.form}"
    if diagnosis.places and diagnosis.verdict == "gap":
        yield "places: " + ", ".join(f"{row.place} {row.share:.0%}" for row in diagnosis.places[:MOST_TOLD])
    if diagnosis.error_responses:
        yield surest_answer(diagnosis)
    yield "found: " + (" + ".join(diagnosis.found) or "nothing to add")
    yield from _retuned(diagnosis, moved)
    if diagnosis.found and diagnosis.shrinkage is not None and diagnosis.shrinkage.fraction is not None:
        interval = diagnosis.shrinkage.fraction_ci95
        within = "" if interval is None else f" (95 %: {interval[0]:.0%} to {interval[1]:.0%})"
        yield f"hold-out: {diagnosis.shrinkage.fraction:.0%} of the removable error gone{within}"
    if diagnosis.firmware is not None:
        yield f"firmware: {firmware_behind_the_first(diagnosis.firmware, diagnosis.note_records)}"
    yield from plain_notes(beside_firmware(diagnosis.firmware, diagnosis.note_records))
    yield quality_sentence(diagnosis_quality(diagnosis))


def _rows(diagnosis: Diagnosis, moved: Sequence[Moved], effects: Mapping[str, Effect]) -> list[tuple[str, str, str]]:
    """All that may explain the gap, the most probable first, and last that nothing does that is known."""
    ranked = []
    for h in diagnosis.effects[:MOST_TOLD]:
        lines = [
            (name if place == 0 else f"  with {name}", f"{h.probability:.3f}" if place == 0 else "", size)
            for place, (name, _, size) in enumerate(sized(h, effects, " "))
        ]
        ranked.append((h.probability, lines))
    alone = parameters_alone(diagnosis)
    # Beside an effect other numbers move than without it.
    ranked.append(
        (alone, [("other parameters alone", f"{alone:.3f}", "" if diagnosis.found else moved_in_words(moved))])
    )
    ranked.sort(key=lambda entry: -entry[0])
    class_ = class_in_words(diagnosis.unknown.class_ or "")
    part = [("a part of the first, and another", f"{diagnosis.partly:.3f}", "")] if diagnosis.partly else []
    unknown = ("unknown", f"{diagnosis.unknown.probability:.3f}", class_)
    return [*(row for _, lines in ranked for row in lines), *part, unknown]


def _retuned(diagnosis: Diagnosis, moved: Sequence[Moved]) -> Iterator[str]:
    """What a re-tune alone does to the hold-out's error, and which numbers moved for it."""
    parts = []
    for output, (stated, now) in lowered(diagnosis).items():
        name, unit, scale = shown(output)
        parts.append(f"{name} {scale * stated:.3g} -> {scale * now:.3g} {unit.strip('[]')}".rstrip())
    if parts:
        yield f"hold-out error as stated -> re-tuned: {', '.join(parts)}"
    if moved and (parts or diagnosis.found or diagnosis.verdict != "gap"):
        beside = " beside what was found" if diagnosis.found else ""
        yield f"moved most{beside}, in standard deviations of what is stated: {moved_in_words(moved)}"
