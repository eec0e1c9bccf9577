"""Rows in the order of their times, where a file has them in another: the newest first, or in the order of another column.

A clock that is set back, ticks that run over and recordings behind one another fall now and then: they stay as they are.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from recordings.signals import Contents, Signal

Array = NDArray[np.float64]
BY_CHANCE = 0.1  # of the rows stand before an older one: half do by chance, one in all behind a clock that was set back
EVEN, EVEN_SHARE = (0.6, 1.6), 0.9  # usual steps that so many of those are at least which putting rows in order makes
NEWEST_FIRST = "the newest row stands first: rows are turned round"


def in_time(contents: Contents) -> Contents:
    """The same with its rows in the order of their times, and what is said of it; as it is where the clock tells no order.

    Of several clocks each must have the newest row first: of rows in another order nobody knows which clock is theirs.
    """
    names = {signal.clock for signal in contents.signals.values() if signal.clock is not None}
    clocks = [contents.signals[name].values for name in names]
    told = {_disorder(t) for t in clocks}
    if len(told) != 1 or (len(clocks) > 1 and told != {NEWEST_FIRST}):
        return contents
    said = told.pop()
    if said is None:
        return contents
    orders = {t.shape: np.argsort(t, kind="stable") for t in clocks}
    return replace(contents, signals=_ordered(contents.signals, orders), found=(*contents.found, said))


def _disorder(t: Array) -> str | None:
    """What is to be said of times (n,) that are rows in another order; None where they are none."""
    if t.ndim != 1 or t.size < 2 or not np.isfinite(t).all():
        return None
    falls = np.diff(t) < 0.0
    order = np.argsort(t, kind="stable")
    steps = np.diff(t[order])
    if not falls.any() or not (steps > 0.0).all():
        return None
    if falls.all():
        return NEWEST_FIRST
    moved = int(np.count_nonzero(order != np.arange(t.size)))
    made = np.diff(order) != 1
    low, high = (share * float(np.median(steps)) for share in EVEN)
    even = float(np.mean((steps[made] >= low) & (steps[made] <= high))) >= EVEN_SHARE
    if even and falls.mean() >= BY_CHANCE:
        return f"{moved} rows stand in another order than their times: put in order"
    return None


def _ordered(signals: Mapping[str, Signal], orders: Mapping[tuple[int, ...], NDArray[np.int64]]) -> dict[str, Signal]:
    """The signals, those as long as a clock with their rows, and the faults of these, in its order."""
    found = dict(signals)
    for name, signal in signals.items():
        order = orders.get(signal.values.shape[:1])
        if order is not None:
            places = {int(row): place for place, row in enumerate(order)} if signal.faults else {}
            faults = {places[row]: told for row, told in signal.faults.items()}
            found[name] = replace(signal, values=signal.values[order], faults=faults)
    return found
