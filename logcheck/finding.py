"""One thing that is odd about a log: what, where, how bad."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
