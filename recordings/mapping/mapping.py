"""A mapping as a record and as a file: which expression gives each column of which plant, and how the file is read."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomlkit

from recordings.layout import FOUND, TextLayout
from records.errors import BadInput
from records.files import write_atomic
from records.logs.sidecar import LOOPS
from records.text import checks
from records.text.reading import read_text, read_toml

SCHEMA = "mapping/1"
_OPTIONS = ("plant", "loop", "group", "per_turn", "separator", "decimal", "skip")


@dataclass(frozen=True)
class ColumnMapping:
    """Expressions by column (`t_s` too); plant and loop; the group that names mean; counts of a turn; how text is laid out.

    What is None was not said.
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    plant: str | None = None
    loop: str | None = None
    group: str | None = None
    per_turn: float | None = None
    layout: TextLayout = FOUND

    def over(self, kept: "ColumnMapping") -> "ColumnMapping":
        """This mapping where it says something, `kept` elsewhere."""
        layout = TextLayout(
            self.layout.separator or kept.layout.separator,
            self.layout.decimal or kept.layout.decimal,
            self.layout.skip or kept.layout.skip,
        )
        return ColumnMapping(
            columns={**kept.columns, **self.columns},
            plant=self.plant or kept.plant,
            loop=self.loop or kept.loop,
            group=self.group or kept.group,
            per_turn=self.per_turn or kept.per_turn,
            layout=layout,
        )


def load_mapping(path: Path) -> ColumnMapping:
    """The mapping in a TOML file; raises BadInput for one that is missing or wrong."""
    content = read_toml(path, "mapping")
    where = str(path)
    checks.schema(content, where, SCHEMA)
    checks.keys(content, where, ("schema", "columns"), _OPTIONS)
    columns = checks.table(content["columns"], f"{where}: columns")
    texts = {
        name: checks.text(content[name], f"{where}: {name}")
        for name in ("plant", "loop", "group", "separator", "decimal")
        if name in content
    }
    if texts.get("loop") not in (None, *LOOPS):
        raise BadInput("loop", where, repr(texts["loop"]), " or ".join(LOOPS), "say how the inputs were made")
    skip = content.get("skip", 0)
    if type(skip) is not int or skip < 0:
        raise BadInput("skip", where, repr(skip), "a whole number of lines", "mend it")
    per_turn = content.get("per_turn")
    return ColumnMapping(
        columns={name: checks.text(text, f"{where}: columns.{name}") for name, text in columns.items()},
        plant=texts.get("plant"),
        loop=texts.get("loop"),
        group=texts.get("group"),
        per_turn=None if per_turn is None else checks.positive(per_turn, f"{where}: per_turn"),
        layout=TextLayout(texts.get("separator"), texts.get("decimal"), skip),
    )


def save_mapping(path: Path, mapping: ColumnMapping) -> bool:
    """Write the mapping to a TOML file, keeping the remarks of one that is there; False where that says the same already."""
    said = {name: value for name, value in _table(mapping).items() if value is not None}
    if path.exists():
        if load_mapping(path) == mapping:
            return False
        document = tomlkit.parse(read_text(path, "mapping"))
    else:
        document = tomlkit.document()
    columns = said.pop("columns")
    for name, value in said.items():
        document[name] = value
    table: Any = document.setdefault("columns", tomlkit.table())
    for name, text in columns.items():
        table[name] = text
    write_atomic(path, tomlkit.dumps(document))
    return True


def _table(mapping: ColumnMapping) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "plant": mapping.plant,
        "loop": mapping.loop,
        "group": mapping.group,
        "per_turn": mapping.per_turn,
        "separator": mapping.layout.separator,
        "decimal": mapping.layout.decimal,
        "skip": mapping.layout.skip or None,
        "columns": dict(mapping.columns),
    }
