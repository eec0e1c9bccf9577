"""Zeros amid numbers that are far from them: a sensor that was not read now and then, or a command that was not written down.

Of a reading nothing is kept. A command went on meanwhile, between those beside it: what was sent is not known, and near to these.
"""

from collections.abc import Iterator

import numpy as np

from logcheck import thresholds
from logcheck.finding import EXCLUDE, Array, Finding, Found, Rows, in_words
from records.log import RunLog
from records.logs.unwritten import LEAP, beside_rows, leap_of


def zero_findings(log: RunLog, name: str, column: str, step: float) -> Iterator[Found]:
    """Rows in which an output reads zero though it is elsewhere just before and just after; of one that does, those at either end of
    the log, which are elsewhere on one side only."""
    values = log.column(column)
    zero = values == 0.0
    others = np.flatnonzero(np.isfinite(values) & ~zero)
    if not zero.any() or others.size < 2:
        return
    moves = np.abs(np.diff(values[others]))
    least = max(float(moves[moves > 0.0].min(initial=np.inf)), step)
    if not np.isfinite(least):
        return
    leap = leap_of(moves, least)
    place, before, after = beside_rows(others, len(values))
    inside: Rows = (place > 0) & (place < others.size)
    near = np.minimum(np.abs(values[before]), np.abs(values[after]))
    gap_s = np.where(inside, log.t_s[after] - log.t_s[before], np.abs(log.t_s - log.t_s[before]))
    near[gap_s > thresholds.DEAD_S] = 0.0  # a stand, which is told with its times
    clear: Rows = zero & (near > leap)
    if not (clear & inside).any():
        return
    # Where zero is written for no reading, one that is merely beside zero is none either.
    unread: Rows = clear | (zero & inside & (near > thresholds.BESIDE_ZERO_STEPS * least))
    a_step_beside: Rows = zero & inside & (near > 0.0) & ~unread
    if a_step_beside.sum() <= unread.sum():  # more are an axis about zero, fewer cost nothing where they were read
        unread = unread | a_step_beside
    at, count = log.t_s[unread], int(unread.sum())
    share = f", {count / len(values):.1%} of all" if count > 1 else ""
    sentence = (
        f"{column} reads 0 in {in_words(count, 'row')}{share}, first at {at[0]:g} s, where it is elsewhere just before and just after; "
        "left out"
    )
    yield Found(Finding("zero_reading", name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, count), unread)


def zero_input_findings(log: RunLog, name: str, column: str) -> Iterator[Found]:
    """Rows in which an input is zero though it is far from it, on one side, just before and just after: a few in a row at most."""
    values = log.column(column)
    others = np.flatnonzero(values != 0.0)
    if others.size in (0, 1, len(values)):
        return
    place, before, after = beside_rows(others, len(values))
    inside: Rows = (values == 0.0) & (place > 0) & (place < others.size)
    near = np.where(
        values[before] * values[after] > 0.0, np.minimum(np.abs(values[before]), np.abs(values[after])), 0.0
    )
    moves = np.diff(values[others])
    beside_it = [np.abs(moves[np.clip(place + shift, 0, moves.size - 1)]) for shift in (-2, -1, 0)]
    leaps = near > np.maximum(_beyond_what_it_does(moves), LEAP * np.max(beside_it, axis=0))
    clear: Rows = inside & leaps
    few: Rows = after - before <= thresholds.BRIDGED_ROWS + 1
    stands = int(np.unique(before[clear & ~few]).size)  # an input that rests at zero for longer was sent there
    unknown: Rows = clear & few
    if not unknown.any() or unknown.mean() > thresholds.MOST_ZEROS or stands > thresholds.ZERO_STANDS * unknown.sum():
        return
    beside: Rows = inside & few & ~clear
    if beside.sum() <= unknown.sum():  # more are a limit at zero, or an input about it
        unknown = unknown | beside
    at, count = log.t_s[unknown], int(unknown.sum())
    share = f", {count / len(values):.1%} of all" if count > 1 else ""
    sentence = (
        f"{column} is 0 in {in_words(count, 'row')}{share}, first at {at[0]:g} s, where it is far from it just before and just after: "
        "what was sent is not written there, and taken as between its neighbours"
    )
    yield Found(Finding("zero_command", name, column, float(at[0]), float(at[-1]), sentence, EXCLUDE, count), unknown)


def _beyond_what_it_does(moves: Array) -> float:
    """How far an input that makes these moves (n,) goes in no row to come back in the next; one that never comes back is of levels."""
    sizes = np.abs(moves)
    back = np.where(moves[:-1] * moves[1:] < 0.0, np.minimum(sizes[:-1], sizes[1:]), 0.0)
    if not back.any():  # one level, and off: so an input is switched
        return thresholds.BESIDE_ZERO_STEPS * float(sizes.min(initial=np.inf, where=sizes > 0.0))
    return leap_of(back, float(back[back > 0.0].min()))
