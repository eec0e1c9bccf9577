"""A last row of sums or means, as a spreadsheet puts one below its columns."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from recordings.signals import Signal

Array = NDArray[np.float64]
LEAST_ROWS = 8  # above: of fewer a clock that counts on, 0 1 2 3, may be the sum of what stands above
TOTALS: Mapping[str, Callable[[Array], float]] = {"sums": np.sum, "means": np.mean}
PRINTED = 1e-2  # of the mean size: totals are printed with fewer digits than they have; a clock that goes on is no total of its past


def without_totals(signals: Mapping[str, Signal]) -> tuple[dict[str, Signal], tuple[str, ...]]:
    """The signals of one table without a last row that is the sum of all above in every column, or the mean; and what is said of it."""
    columns = [signal.values for signal in signals.values() if signal.values.ndim == 1 and np.any(signal.values)]
    kind = next((kind for kind in TOTALS if _all_are(columns, kind)), None)
    if kind is None:
        return dict(signals), ()
    return {name: _shorter(signal) for name, signal in signals.items()}, (
        f"the last row has the {kind} of those above and is left out",
    )


def _all_are(columns: Sequence[Array], kind: str) -> bool:
    """Whether the last of each of two columns and more is such a total of what stands above."""
    if len(columns) < 2 or len(columns[0]) <= LEAST_ROWS:
        return False
    return all(
        abs(column[-1] - TOTALS[kind](column[:-1])) <= PRINTED * float(TOTALS[kind](np.abs(column[:-1])))
        for column in columns
    )


def _shorter(signal: Signal) -> Signal:
    last = len(signal.values) - 1
    faults = {row: told for row, told in signal.faults.items() if row != last}
    return replace(signal, values=signal.values[:-1], faults=faults)
