"""What every importer hands on: the numbers of one run in SI units, before they become a log of a plant."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Load = Callable[[str], bytes]  # file name in the dataset's folder -> its verified content


@dataclass(frozen=True, eq=False)
class Recording:
    """A run of n samples: `columns` by the name that the plant's log gives them, each (n,), outputs NaN where not measured.

    Inputs hold from their row's time to the next; `notes` are sentences for the reader of the numbers.
    """

    t_s: Array
    columns: Mapping[str, Array]
    sample_period_s: float
    loop: str
    locked: tuple[str, ...] = ()
    simulated: bool = False
    notes: tuple[str, ...] = field(default=())


class Importer(Protocol):
    """A module that reads one dataset."""

    @property
    def RECORDS(self) -> tuple[str, ...]:
        """The names of its runs."""
        ...

    def read(self, record: str, load: Load) -> Recording:
        """The run called `record`, one of RECORDS; raises BadInput for content that is not what was published."""
        ...


def limit_notes(name: str, values: ArrayLike, lower: float, upper: float) -> tuple[str, ...]:
    """Says in how many of its rows (n,) an input lies at or beyond the limits of its drive, in its own unit, if in any."""
    rows = np.asarray(values)
    low, high = int(np.sum(rows <= lower)), int(np.sum(rows >= upper))
    parts = [
        f"{count} at {limit:g} or {side}"
        for count, limit, side in ((low, lower, "below"), (high, upper, "above"))
        if count
    ]
    return (f"{name} reaches its limits: of {rows.size} rows {', '.join(parts)}",) if parts else ()


def gap_notes(t_s: Array, sample_period_s: float) -> tuple[str, ...]:
    """Says how many gaps the time stamps t_s (n,) have, wider than 1.5 sample periods, if any."""
    steps = np.diff(t_s)
    wide = steps[steps > 1.5 * sample_period_s]
    if not wide.size:
        return ()
    return (f"gaps longer than 1.5 sample periods: {wide.size}, the longest {wide.max():.4g} s",)


def missing_notes(name: str, values: Array) -> tuple[str, ...]:
    """Says in how many of its rows (n,) nothing was measured (NaN), if in any."""
    missing = int(np.isnan(values).sum())
    if missing == values.size:
        return (f"{name} was not recorded: NaN",)
    return (f"{name} is missing in {missing} of {values.size} rows: NaN",) if missing else ()
