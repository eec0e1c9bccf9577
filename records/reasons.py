"""Why an answer is what it is: the rules that had a say, and what else is to be known of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

THINNED = "thinned_rows"
# Kinds of notes that stand before any verdict: a column that may be another than it is called makes whatever follows doubtful, and so do
# a clock that may be wrong and commands that nobody wrote down.
DOUBTS = ("columns_doubted", "columns_late", "columns_early", "clock_doubted", THINNED)


@dataclass(frozen=True)
class Decision:
    """A rule that had a say: its name, of what it asked, the value that it found, the limit that it held this against, both in `unit`,
    and what followed; None for a value or a limit that is no finite number."""

    rule: str
    of: str
    value: float | None
    limit: float | None
    unit: str
    outcome: str


@dataclass(frozen=True)
class Note:
    """Something to be known beside an answer: what kind of thing, of what, and its numbers, each with its unit in the name or beside it.

    `said` is the sentence where whoever found it made one; else the sentence follows from the kind.
    """

    kind: str
    subject: str
    numbers: Mapping[str, Any] = field(default_factory=dict)
    said: str | None = None
