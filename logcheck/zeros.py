"""Readings of zero amid others that are far from it: a sensor that was not read now and then, and for which zero was written down."""

from collections.abc import Iterator

import numpy as np

from logcheck import thresholds
from logcheck.finding import EXCLUDE, Finding, Found, Rows, in_words
from records.log import RunLog


def zero_findings(log: RunLog, name: str, column: str, step: float) -> Iterator[Found]:
    """Rows in which an output reads zero though it is elsewhere just before and just after."""
    values = log.column(column)
    zero = values == 0.0
    others = np.flatnonzero(np.isfinite(values) & ~zero)
    if not zero.any() or others.size < 2:
        return
    moves = np.abs(np.diff(values[others]))
    least = max(float(moves[moves > 0.0].min(initial=np.inf)), step)
    if not np.isfinite(least):
        return
    leap = max(
        thresholds.DEAD_JUMP * float(np.percentile(moves, thresholds.USUAL_MOVE_PERCENT)),
        thresholds.DEAD_JUMP_STEPS * least,
    )
    place = np.searchsorted(others, np.arange(len(values)))
    before, after = (np.abs(values[others[np.clip(place - back, 0, others.size - 1)]]) for back in (1, 0))
    near = np.minimum(before, after)
    near[: others[0]] = 0.0
    near[others[-1] :] = 0.0
    gap_s = (
        log.t_s[others[np.clip(place, 0, others.size - 1)]] - log.t_s[others[np.clip(place - 1, 0, others.size - 1)]]
    )
    near[gap_s > thresholds.DEAD_S] = 0.0  # a stand, which is told with its times
    clear: Rows = zero & (near > leap)
    if not clear.any():
        return
    # Where zero is written for no reading, one that is merely beside zero is none either.
    unread: Rows = zero & (near > thresholds.BESIDE_ZERO_STEPS * least)
    a_step_beside: Rows = zero & (near > 0.0) & ~unread
    if a_step_beside.sum() <= unread.sum():  # more are an axis about zero, fewer cost nothing where they were read
        unread = unread | a_step_beside
    at, count = log.t_s[unread], int(unread.sum())
    share = f", {count / len(values):.1%} of all" if count > 1 else ""
    sentence = (
        f"{column} reads 0 in {in_words(count, 'row')}{share}, first at {at[0]:g} s, where it is elsewhere just before and just after; "
        "left out"
    )
    yield Found(Finding("zero_reading", name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, count), unread)
