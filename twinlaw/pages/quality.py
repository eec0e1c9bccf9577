"""The colour of a result as people read it: one sentence, and the table of what it stands on."""

from collections.abc import Iterable

from records.quality import CRITERIA, RANK, Look, Quality, worst
from twinlaw.pages.page import Row, Section, Table

ROUNDING = 1e-9  # in a criterion's unit: limits are 0.1 and more, double precision leaves this of 0
SAID = 3  # reasons that are named in the sentence
BY_NAME = {criterion.name: criterion for criterion in CRITERIA}
HEADING = ("looked at", "how many", "worst", "of", "green up to", "amber up to", "colour")


def quality_sentence(quality: Quality) -> str:
    """The colour, and why it is not green."""
    word = str(quality.colour).capitalize()
    if not quality.looks:
        return f"{word}: there is nothing to judge it by."
    if not quality.reasons:
        return f"{word}: whatever was looked at lies within its limits, and no flag is raised."
    told = [
        _reason(look)
        for look in sorted(quality.reasons, key=lambda look: (RANK[look.colour], _size(look)), reverse=True)
    ]
    more = f"; {len(told) - SAID} more" if len(told) > SAID else ""
    return f"{word}: {'; '.join(told[:SAID])}{more}."


def quality_told(quality: Quality, cause: str, before: str = "") -> str:
    """The colour, and why it is not green; behind it, where it is known, the cause of that, but for lines that were told before."""
    lines = [line for line in cause.splitlines() if line not in before.splitlines()]
    return " ".join((quality_sentence(quality), *lines))


def _size(look: Look) -> float:
    """How far beyond green, by factor; flags come first."""
    if look.criterion not in BY_NAME:
        return float("inf")
    return (look.value if look.value is not None else float("inf")) / BY_NAME[look.criterion].green


def _reason(look: Look) -> str:
    if look.criterion not in BY_NAME:
        return look.of
    return f"{look.criterion} of {look.of} {_figure(look.value, look.unit)}, green up to {_limit(look.criterion)}"


def _figure(value: float | None, unit: str) -> str:
    return "not finite" if value is None else f"{value if abs(value) > ROUNDING else 0.0:.3g} {unit}".rstrip()


def _limit(criterion: str) -> str:
    known = BY_NAME[criterion]
    return f"{known.green:g} {known.unit}".rstrip()


def quality_rows(quality: Quality) -> list[Row]:
    """One row a criterion, with the worst of what was looked at, and one a flag."""
    counts = [look.criterion for look in quality.looks]
    rows: list[Row] = [
        (
            BY_NAME[name].what,
            f"{counts.count(name)}",
            _figure(look.value, look.unit),
            look.of,
            _limit(name),
            f"{BY_NAME[name].amber:g} {BY_NAME[name].unit}".rstrip(),
            str(look.colour),
        )
        for name, look in quality.by_criterion.items()
        if name in BY_NAME
    ]
    flags = [look for look in quality.looks if look.criterion not in BY_NAME]
    return rows + [("flag", "", "", look.of, "", "", str(look.colour)) for look in flags]


def quality_section(quality: Quality) -> Section:
    """The last part of every page that has a colour."""
    rows = quality_rows(quality)
    tables = (Table(rows, HEADING),) if rows else ()
    return Section("What the colour stands on", (quality_sentence(quality),), tables)


def colour_of(looks: Iterable[Look]) -> str:
    """The colour of a table's row, by what was looked at in it; empty where nothing was."""
    found = [look.colour for look in looks]
    return str(worst(found)) if found else ""
