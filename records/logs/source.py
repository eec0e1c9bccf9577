"""Where an imported run log comes from: the published recording, and what a reader of its numbers must know."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from records.errors import BadInput
from records.text import checks

_TEXTS = ("dataset", "record", "repository", "commit", "licence")


@dataclass(frozen=True)
class Source:
    """A recording by dataset and record, its upstream repository at a commit, its licence.

    `simulated` marks numbers that a model made, not a rig; `notes` are sentences on units, clipping, clocks and gaps.
    """

    dataset: str
    record: str
    repository: str
    commit: str
    licence: str
    simulated: bool = False
    notes: tuple[str, ...] = ()


def source_table(source: Source) -> dict[str, Any]:
    """The section [source] of a sidecar."""
    texts = {name: getattr(source, name) for name in _TEXTS}
    return {**texts, "simulated": source.simulated, "notes": list(source.notes)}


def parse_source(section: Any, where: str) -> Source:
    """A source from the section [source] of a sidecar; raises BadInput for a wrong key or kind."""
    table: Mapping[str, Any] = checks.table(section, where)
    checks.keys(table, where, (*_TEXTS, "simulated", "notes"))
    if not isinstance(table["simulated"], bool):
        raise BadInput("simulated", where, repr(table["simulated"]), "true or false", "say what made the numbers")
    if not isinstance(table["notes"], list):
        raise BadInput("notes", where, repr(table["notes"]), "a list of sentences", "write [] where there are none")
    notes = tuple(checks.text(note, f"{where}.notes") for note in table["notes"])
    texts = {name: checks.text(table[name], f"{where}.{name}") for name in _TEXTS}
    return Source(**texts, simulated=table["simulated"], notes=notes)
