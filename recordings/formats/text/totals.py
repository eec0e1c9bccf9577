"""A last row of sums or means, as a spreadsheet puts one below its columns."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from recordings.signals import Signal

Array = NDArray[np.float64]
LEAST_ROWS = 8  # above: of fewer a clock that counts on, 0 1 2 3, may be the sum of what stands above
PRINTED = 1e-2  # of the size of a total: they are printed with fewer digits than they have


def _summed(x: Array) -> tuple[float, float]:
    return float(np.sum(x)), float(np.sum(np.abs(x)))


def _averaged(x: Array) -> tuple[float, float]:
    """By how far a column moves: of a clock that counts from 1970 every row is the mean of all but for a millionth."""
    return float(np.mean(x)), float(np.ptp(x))


# A total of a column (rows,), and its size, by which what was printed is told from it.
TOTALS: Mapping[str, Callable[[Array], tuple[float, float]]] = {"sums": _summed, "means": _averaged}


def without_totals(signals: Mapping[str, Signal]) -> tuple[dict[str, Signal], tuple[str, ...]]:
    """The signals of one table without a last row that is the sum of all above in every column that moves, or the mean; and what is said
    of it."""
    columns = [
        signal.values for signal in signals.values() if signal.values.ndim == 1 and len(signal.values) > LEAST_ROWS
    ]
    moving = [column for column in columns if np.ptp(column[:-1]) != 0.0]
    kind = next(
        (kind for kind in TOTALS if len(moving) > 1 and all(_is_total(column, kind) for column in moving)), None
    )
    if kind is None:
        return dict(signals), ()
    return {name: _shorter(signal) for name, signal in signals.items()}, (
        f"the last row has the {kind} of those above and is left out",
    )


def _is_total(column: Array, kind: str) -> bool:
    """Whether the last of a column is such a total of what stands above."""
    total, size = TOTALS[kind](column[:-1])
    return bool(abs(column[-1] - total) <= PRINTED * size)


def _shorter(signal: Signal) -> Signal:
    last = len(signal.values) - 1
    faults = {row: told for row, told in signal.faults.items() if row != last}
    return replace(signal, values=signal.values[:-1], faults=faults)
