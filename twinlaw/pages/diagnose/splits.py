"""The splits of a rig's logs as a table, for a terminal and for a page, and how far their names agree."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

HEADING = (
    "explained",
    "held out",
    "verdict",
    "found",
    "most likely",
    "probability",
    "unknown",
    "gone in 1 s",
    "whole run",
    "CPU [s]",
)


def rows(told: Sequence[Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """A line for each split; "gone" is the share of the removable error that is gone on the hold-out."""
    return [_row(entry) for entry in told]


def _row(entry: Mapping[str, Any]) -> tuple[str, ...]:
    names = (", ".join(entry["explained"]), ", ".join(entry["held_out"]))
    if "failure" in entry:
        return (*names, "not answered", *[""] * (len(HEADING) - 3))
    first = entry["first"]
    return (
        *names,
        entry["verdict"],
        " + ".join(entry["found"]) or "nothing",
        first["effect"] if first else "",
        f"{first['probability']:.2f}" if first else "",
        f"{entry['unknown']:.2f}",
        _gone(entry["one_second"]),
        _gone(entry["whole_run"]),
        f"{entry['cpu_s']:.1f}",
    )


def _gone(errors: Mapping[str, Any] | None) -> str:
    return "" if errors is None or errors["fraction"] is None else f"{errors['fraction']:.0%}"


def markdown(told: Sequence[Mapping[str, Any]]) -> str:
    """The same table for a page."""
    lines = [HEADING, ["---"] * len(HEADING), *rows(told)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def agreement(told: Mapping[str, Any], splits: Sequence[Mapping[str, Any]]) -> str:
    """Sentences on how far the names of all splits agree, `told` as splits.json has it, and on what those say that name nothing."""
    naming = told["naming"]
    rest = Counter(_nameless(entry) for entry in splits if not entry.get("found"))
    others = f" The others say: {', '.join(f'{what} {count}' for what, count in rest.most_common())}." if rest else ""
    if not naming:
        return f"None of {len(splits)} splits adds an effect.{others}"
    most, effect = " + ".join(told["most_frequent"]), told["effect"]
    return (
        f"Of {len(splits)} splits {naming} add effects, and of these {_share(told['same'], naming)} the same, {most}, and "
        f"{_share(told['alike'], naming)} that or what looks the same to them. "
        f"{effect}, alone or with others, is added by {_share(told['sharing'], naming)}.{others}"
    )


def _share(count: int, of: int) -> str:
    return f"{count} ({count / of:.0%})"


def _nameless(entry: Mapping[str, Any]) -> str:
    """What a split says that adds nothing: a gap without a name, one whose name was not added, or no gap."""
    if "failure" in entry:
        return "not answered"
    if entry["verdict"] != "gap":
        return str(entry["verdict"])
    first = entry["first"]
    return "gap, unknown" if first is None or entry["unknown"] >= first["probability"] else "gap, nothing added"
