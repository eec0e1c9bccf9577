"""Readings that are repeated until the next one comes: rows that stand twice, sensors sampled slower than the log."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import EXCLUDE, Finding, Found, Rows
from records.log import RunLog


def held_findings(log: RunLog, name: str) -> Iterator[Found]:
    """Outputs that all change at every m-th row only: the rows between repeat old readings and are left out."""
    changed = np.flatnonzero((np.diff(log.y, axis=0) != 0.0).any(axis=1)) + 1
    period, turn = _turn(changed)
    if period == 1:
        return
    repeated: Rows = np.arange(len(log.t_s)) % period != turn
    stale = ~np.isin(np.arange(len(log.t_s)), changed) & repeated
    at = log.t_s[stale]
    sentence = (
        f"the outputs change at every {_ordinal(period)} row only: the readings between are repeated, and left out"
    )
    finding = Finding("held_readings", name, None, float(at[0]), float(at[-1]), sentence, EXCLUDE, int(stale.sum()))
    yield Found(finding, stale)


def _turn(changed: NDArray[np.int64]) -> tuple[int, int]:
    """The longest period in rows, and the row within it, at which nearly all changes come; (1, 0) where there is none."""
    if len(changed) < thresholds.LEAST_HELD_CHANGES:
        return 1, 0
    for period in range(thresholds.LONGEST_HOLD_ROWS, 1, -1):
        counts = np.bincount(changed % period, minlength=period)
        if counts.max() >= thresholds.SAME_TURN_SHARE * len(changed):
            return period, int(np.argmax(counts))
    return 1, 0


def _ordinal(period: int) -> str:
    return {2: "second", 3: "third"}.get(period, f"{period}th")
