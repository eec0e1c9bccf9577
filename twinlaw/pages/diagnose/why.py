"""Why an answer is what it is: the exit that was taken, and every rule that had a say on the way there."""

from collections.abc import Iterator

from records.diagnosis import Diagnosis
from records.reasons import Decision
from twinlaw.cli import console
from twinlaw.pages.diagnose.words import window
from twinlaw.pages.page import Section, Table

SMALL = (
    "unexplained",
    "too_small",
    "too_unsure",
)  # exits of a gap that has no explanation that holds, or none that surely does
HEADING = ("rule", "of", "value", "limit", "unit", "what followed")
# By the word of an exit (diagnosis/result.py): what it means for who reads the answer.
_REASONS = {
    "nothing_seen": "What these logs hold beyond the plant as stated is no more than chance gives.",
    "too_little_seen": "Most effects of the library would go unseen in these logs, so that nothing shows in them says little.",
    "yielding_explains": "Axes that creep or give near rest, as dry friction does, explain what looked like a gap.",
    "unexplained": "What shows beyond noise is small, and neither an effect of sure size nor other parameters explain it.",
    "too_small": "What would explain the rest brings predictions over {window} hardly closer, so none of it is told.",
    "too_unsure": "What would explain the rest may bring predictions over {window} closer, but not surely: more logs would tell.",
    "effect_added": "The likeliest effect is likelier than an unknown one, and nothing speaks against it.",
    "parameters_alone": "Other values of the plant's own parameters are the likeliest explanation.",
    "named_not_added": "The likeliest effect does not predict the hold-out logs better, so the model stays without it.",
    "unknown_effect": "That no effect of the library is the cause is likelier than any that is.",
}


def reason_in_words(diagnosis: Diagnosis) -> str:
    """What the exit that was taken means; empty where the file names none."""
    return _REASONS.get(diagnosis.verdict_reason or "", "").format(window=window(diagnosis))


def why_section(diagnosis: Diagnosis) -> Section | None:
    """The page's section; None for an answer that kept no rules."""
    if not diagnosis.decisions:
        return None
    told = "Each row is a rule that had a say, in the order in which they were asked: what it looked at, and its limit."
    return Section("Why this answer", (reason_in_words(diagnosis), told), (Table(_rows(diagnosis), HEADING),))


def why_text(diagnosis: Diagnosis) -> str:
    """The same for a terminal."""
    return "\n".join(_lines(diagnosis)) + "\n"


def _lines(diagnosis: Diagnosis) -> Iterator[str]:
    yield f"{diagnosis.verdict}: {diagnosis.verdict_reason or 'no reason kept'}"
    if reason_in_words(diagnosis):
        yield reason_in_words(diagnosis)
    if diagnosis.decisions:
        yield console.table(_rows(diagnosis), HEADING)


def _rows(diagnosis: Diagnosis) -> list[tuple[str, ...]]:
    return [_row(entry) for entry in diagnosis.decisions]


def _row(entry: Decision) -> tuple[str, ...]:
    return (
        entry.rule.replace("_", " "),
        entry.of,
        _number(entry.value),
        _number(entry.limit),
        entry.unit,
        entry.outcome,
    )


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"
