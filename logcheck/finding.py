"""One thing that is odd about a log: what, where, how bad."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from records.log import RunLog

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

NOTE, EXCLUDE, REFUSE = "note", "exclude", "refuse"


@dataclass(frozen=True)
class Finding:
    """What was found in a log, as a sentence for a person.

    `severity`: "note" changes nothing, "exclude" leaves `rows` rows out, "refuse" means that nothing can be concluded from the log;
    then `expected` and `remedy` say what would do. `column` None: the log as a whole.
    """

    kind: str
    log: str
    column: str | None
    start_s: float
    end_s: float
    sentence: str
    severity: str = NOTE
    rows: int = 0
    expected: str = ""
    remedy: str = ""


@dataclass(frozen=True, eq=False)
class Found:
    """A finding with the rows (n,) that it leaves out, and those (n,) with which another log begins; None where there are none.

    Of rows that are left out for what an output reads, only that reading is; for what an input is, only that command, which is not known.
    """

    finding: Finding
    excluded: Rows | None = None
    begins: Rows | None = None


def in_words(count: int, thing: str) -> str:
    """ "1 row", "3 rows"."""
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def beginning(found: Iterable[Found], rows: int) -> Rows:
    """The rows (n,) with which another log begins."""
    begins: Rows = np.zeros(rows, bool)
    for entry in found:
        begins |= begins if entry.begins is None else entry.begins
    return begins


def without(log: RunLog, found: Sequence[Found]) -> RunLog:
    """The log with nothing read where readings were found to be none, and commands between their neighbours where they were."""
    y = np.where(marked(log.columns.outputs, found, len(log.t_s)), np.nan, log.y)
    return replace(log, y=y, u=bridged(log, marked(log.columns.inputs, found, len(log.t_s)))) if found else log


def marked(columns: Sequence[str], found: Iterable[Found], rows: int) -> Rows:
    """What was found to be left out of each of these columns alone (rows, columns)."""
    out: Rows = np.zeros((rows, len(columns)), bool)
    for entry in found:
        if entry.finding.column in columns and entry.excluded is not None:
            out[:, columns.index(entry.finding.column)] |= entry.excluded
    return out


def bridged(log: RunLog, unknown: Rows) -> Array:
    """The inputs (n, inputs), those that are `unknown` (n, inputs) on the line between their neighbours."""
    u = log.u.copy()
    for column, rows in zip(u.T, unknown.T, strict=True):
        column[rows] = np.interp(log.t_s[rows], log.t_s[~rows], column[~rows]) if rows.any() else column[rows]
    return u
