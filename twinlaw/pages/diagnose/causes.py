"""What causes a gap: the ranked effects, other parameters, and that nothing of the library does."""

from collections.abc import Mapping, Sequence

from records.diagnosis import Diagnosis, RankedHypothesis
from sim.effect import Effect
from twinlaw.pages.diagnose.retune import Moved, moved_in_words, parameters_alone
from twinlaw.pages.diagnose.words import class_in_words, listed, percent, sized, words
from twinlaw.pages.page import Section, Table

ALWAYS, SELDOM = 3, 0.01  # the first few causes are always shown, further ones from this probability


def causes_section(diagnosis: Diagnosis, effects: Mapping[str, Effect], moved: Sequence[Moved]) -> Section | None:
    if not diagnosis.effects and not diagnosis.unknown.probability:
        return None
    told = [f"{words(name).capitalize()}: {effects[name].story}" for name in diagnosis.found if name in effects]
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
    ranked = [(h.probability, _cause_rows(h, set(h.names) == set(diagnosis.found), effects)) for h in shown_ones]
    if retuned > SELDOM:
        # Beside an effect other numbers move than without it.
        own = "" if diagnosis.found else moved_in_words(moved)
        ranked.append((retuned, [("other parameters alone", "", percent(retuned), own, "")]))
    ranked.sort(key=lambda entry: -entry[0])
    rows = [row for _, lines in ranked for row in lines]
    if diagnosis.partly > SELDOM:
        rows.append(("a part of the first, and another effect", "", percent(diagnosis.partly), "", ""))
    class_ = class_in_words(unknown.class_ or "")
    rows.append(("none of the library", class_, percent(unknown.probability), "", ""))
    return Section(
        "What causes it",
        told,
        (Table(rows, ("effect", "depends on, acts on", "probability", "size", "looks the same")),),
    )


def _cause_rows(hypothesis: RankedHypothesis, found: bool, effects: Mapping[str, Effect]) -> list[tuple[str, ...]]:
    """A row for each effect, those that it is joint with below the first."""
    rows: list[tuple[str, ...]] = []
    for place, (name, class_, size) in enumerate(sized(hypothesis, effects)):
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
