"""The controller table that a log names: given, or found beside the log."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.law_table import SCHEMA
from records.log import RunLog
from records.table import ControllerTable, load_table
from records.text.reading import read_json
from replay.firmware import FirmwareReplay
from replay.stretches import replay_stretches

TABLE_NAME = "controller.json"
TABLE_NOT_FOUND = "table_not_found"


def replay_log(
    log: RunLog, path: Path, tables: Sequence[ControllerTable] = (), begins: NDArray[np.bool_] | None = None
) -> FirmwareReplay | None:
    """Run the firmware again that the log at `path` names; None where it names none.

    Its table is one of `tables`, or controller.json in the log's folder. The other tables are tried as what may have flown instead.
    With the rows `begins` (n,) another recording begins.
    Raises BadInput when tables are given and the log names none of them.
    """
    if log.table_digest is None:
        return None
    known = {table.digest: table for table in (*tables, *_beside(path))}
    table = known.pop(log.table_digest, None)
    if table is not None:
        return replay_stretches(log, table, tuple(known.values()), begins)
    if tables:
        raise BadInput(
            "run log",
            str(path),
            f"a flight of table {log.table_digest[:16]}",
            f"one of table {tables[0].digest[:16]}",
            "give the table that flew, or a log of this table",
        )
    sentence = f"table {log.table_digest[:16]}, which the log names, is not beside it as {TABLE_NAME}"
    other = _other_controller(path, log.table_digest)
    if other is not None:
        sentence = f"the log was flown by the controller {other!r}; the scheduled law's firmware alone is run again"
    return FirmwareReplay(False, False, None, TABLE_NOT_FOUND, sentence)


def _other_controller(path: Path, digest: str) -> str | None:
    """The controller of the table of this digest beside the log, where it is not the scheduled law's."""
    try:
        content = read_json(path.with_name(TABLE_NAME), "controller table", "", "")
    except BadInput:
        return None
    known = isinstance(content, dict) and content.get("schema") == SCHEMA and content.get("digest") == digest
    return str(content.get("controller")) if known else None


def table_of(log: RunLog, path: Path) -> ControllerTable | None:
    """The table that the log at `path` names, where it lies beside it."""
    if log.table_digest is None:
        return None
    return next((table for table in _beside(path) if table.digest == log.table_digest), None)


def timed_by_table(log: RunLog, path: Path, table: ControllerTable | None = None) -> RunLog:
    """The log at `path` with the sample period of the table that flew it, `table` or the one beside it, whatever its sidecar states.

    A log of every fourth sample whose sidecar states the time between its rows is told by that.
    """
    table = table_of(log, path) if table is None else table
    is_own = table is not None and table.digest == log.table_digest
    return log if table is None or not is_own else replace(log, sample_period_s=table.sample_period_s)


def _beside(path: Path) -> tuple[ControllerTable, ...]:
    """The table in the log's folder, if one is there and whole."""
    try:
        return (load_table(path.with_name(TABLE_NAME)),)
    except BadInput:
        return ()
