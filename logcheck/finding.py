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

    Of rows that are left out for what an output reads, only that reading is.
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
    """The log with nothing read where readings were found to be none."""
    y = log.y.copy()
    for entry in found:
        if entry.finding.column in log.columns.outputs and entry.excluded is not None:
            y[entry.excluded, log.columns.outputs.index(entry.finding.column)] = np.nan
    return replace(log, y=y) if found else log
