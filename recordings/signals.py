"""What a file holds, whatever its format: signals by name, each with its unit and its clock."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import accumulate, groupby

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Signal:
    """One recorded quantity: values (n,), or an array of which a mapping picks a row or column, as the file has them.

    `unit` is what the file states, empty where it states none; `clock` names the signal of the file that holds its times; `faults`
    tells by row what stood there in place of a number; `heading` is the name with all that the file writes around it;
    `instants`: its values are dates or times of day.
    """

    values: Array
    unit: str = ""
    clock: str | None = None
    faults: Mapping[int, str] = field(default_factory=dict)
    heading: str = ""
    instants: bool = False


class Unmapped(BadInput):
    """Columns that no signal of the file is known to be: which one is must be said."""


@dataclass(frozen=True, eq=False)
class Contents:
    """Signals by name (`run1.psi_rad`, `ScopeData.signals(2).values`), texts by name (loop, table_digest), and what was found unasked.

    `unread` tells by name what the file holds that is no signal; `singles` are numbers of one value; `locked` axes are stated by a file
    that was made of a run log alone. `groups` are the groups of signals by the names that the file gives them.
    """

    signals: Mapping[str, Signal]
    texts: Mapping[str, str] = field(default_factory=dict)
    found: tuple[str, ...] = ()
    unread: Mapping[str, str] = field(default_factory=dict)
    locked: tuple[str, ...] = ()
    singles: Mapping[str, Signal] = field(default_factory=dict)
    groups: Mapping[str, str] = field(default_factory=dict)


def listed(names: Mapping[str, object] | list[str] | tuple[str, ...], most: int = 300) -> str:
    """Names in a row for an error's line, entries of one array as `output[0..15]`; as many as `most` characters hold, and how many more."""
    short = list(_in_short(list(names)))
    lengths = accumulate(len(name) + 2 for name in short)
    fitting = max(1, sum(length <= most for length in lengths))
    more = f" and {len(short) - fitting} more" if fitting < len(short) else ""
    return ", ".join(short[:fitting])[:most] + more or "nothing of numbers"


def counted(number: int, things: str) -> str:
    """A number of things, the last letter of whose name goes where there is but one: `1 sample`, `2 samples`."""
    return f"{number} {things[:-1] if number == 1 else things}"


def _in_short(names: list[str]) -> Iterator[str]:
    for stem, entries in groupby(names, key=lambda name: re.sub(r"\[\d+\]$", "", name)):
        own = list(entries)
        yield f"{own[0][:-1]}..{own[-1][len(stem) + 1 :]}" if len(own) > 1 and own[0] != stem else own[0]
