"""Readings that are repeated until the next one comes: rows that stand twice, sensors sampled slower than the log, readings that come late
now and then."""

from collections.abc import Collection, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import EXCLUDE, Array, Finding, Found, Rows, in_words
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


def stale_findings(log: RunLog, name: str, steps: Mapping[str, float], positions: Collection[str]) -> Iterator[Found]:
    """Readings of `positions`, outputs that a mass moves, that repeat the one before while the axis goes on: it is under way before and
    behind, and between it stands and leaps. Fewer than DEAD_ROWS in a row, as longer ones are dead stretches."""
    for column in (column for column in log.columns.outputs if column in positions):
        values, stale = log.column(column), np.zeros(len(log.t_s), bool)
        moves = np.diff(values)
        least = thresholds.STALE_STEPS * max(
            float(np.min(np.abs(moves), initial=np.inf, where=np.abs(moves) > 0.0)), steps.get(column, 0.0)
        )
        for rows in range(1, thresholds.DEAD_ROWS - 1):
            first = 1 + np.flatnonzero(_stands_and_leaps(moves, rows, least))
            stale[(first[:, np.newaxis] + 1 + np.arange(rows)).ravel()] = True
        if stale.sum() >= max(thresholds.LEAST_STALE, thresholds.LEAST_STALE_SHARE * len(values)):
            at, count = log.t_s[stale], int(stale.sum())
            share = f"{in_words(count, 'row')}, {count / len(values):.1%} of all, first at {at[0]:.6g} s"
            sentence = f"{column} repeats the reading before, though its axis goes on, in {share}; left out"
            yield Found(
                Finding("stale_readings", name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, count), stale
            )


def _stands_and_leaps(moves: Array, rows: int, least: float) -> Rows:
    """Places (n,) behind whose move the column stands for so many rows, and leaps on: as far as it would have gone, by the moves before and
    behind, which are at least so far and one way."""
    count = len(moves) - rows - 2
    if count < 1:
        return np.zeros(0, bool)
    before, leap, behind = moves[:count], moves[rows + 1 : rows + 1 + count], moves[rows + 2 : rows + 2 + count]
    stands = np.all([moves[1 + row : 1 + row + count] == 0.0 for row in range(rows)], axis=0)
    with np.errstate(invalid="ignore"):
        one_way = (before * leap > 0.0) & (behind * leap > 0.0)
        fast = np.minimum(np.abs(before), np.abs(behind)) >= least
        far = np.abs(leap) > thresholds.STALE_LEAP * np.maximum(np.abs(before), np.abs(behind))
    return np.asarray(stands & one_way & fast & far)


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
