"""What a file holds, whatever its format: signals by name, each with its unit and its clock."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

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


@dataclass(frozen=True, eq=False)
class Contents:
    """Signals by name (`run1.psi_rad`, `ScopeData.signals(2).values`), texts by name (loop, table_digest), and what was found unasked.

    `unread` tells by name what the file holds that is no signal; `singles` are numbers of one value; `locked` axes are stated by a file
    that was made of a run log alone.
    """

    signals: Mapping[str, Signal]
    texts: Mapping[str, str] = field(default_factory=dict)
    found: tuple[str, ...] = ()
    unread: Mapping[str, str] = field(default_factory=dict)
    locked: tuple[str, ...] = ()
    singles: Mapping[str, Signal] = field(default_factory=dict)


def listed(names: Mapping[str, object] | list[str] | tuple[str, ...], most: int = 300) -> str:
    """Names in a row for an error's line, cut at `most` characters."""
    text = ", ".join(names) or "nothing of numbers"
    return text if len(text) <= most else f"{text[: most - 3]}..."
