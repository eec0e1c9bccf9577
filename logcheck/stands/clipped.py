"""A sensor at the end of its range: it stands at the greatest or the least that it reads while its axis goes on beyond.

An axis that turns back, or meets a stop, leaves the end of its way from rest, by a third of the way that it goes in as much time behind.
Where a position comes to its extreme, stands there and leaves it at full speed, the way between was not read. What no mass moves may leave
its rest at full speed, and so may, as a coarse sensor sees it, what an input just set going: these must come as evenly too. A sensor behind
play, and an axis that sticks, stand so wherever they turn back: an end of a range is met more than once. Of a sensor whose readings are
never twice the same, a stand at an extreme is that by itself, but for one at zero, where it may rest.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from logcheck import thresholds
from logcheck.finding import EXCLUDE, Finding, Found, Rows
from logcheck.stands.column import Readings, evenness, hardly_repeats, is_set_going, readings_of, runs
from records.log import RunLog
from records.text.units import unit_of


@dataclass(frozen=True)
class _End:
    """An end of a sensor's range: its level, how it is told, and the stands there as first and last rows."""

    level: float
    how: str
    stands: list[tuple[int, int]]


def clipped_findings(
    log: RunLog,
    name: str,
    steps: Mapping[str, float],
    begins: Rows,
    positions: Collection[str] = (),
    stops: Mapping[str, tuple[float, float]] = MappingProxyType({}),
) -> Iterator[Found]:
    """The ends of each output's range at which its sensor stood, whose readings are left out; with the rows `begins` (n,) another log
    begins.

    `positions` are outputs that a mass moves, `stops` [rad] where it is stopped: there no sensor need end.
    """
    for column in log.columns.outputs:
        read = readings_of(log, column, begins, positions)
        low, high = stops.get(column, (-np.inf, np.inf))
        margin = thresholds.BEYOND_STOP_rad
        ends = [end for end in _ends(read, steps.get(column, 0.0)) if low + margin < end.level < high - margin]
        if not ends:
            continue
        unread: Rows = np.zeros(len(log.t_s), bool)
        for end in ends:
            unread[read.rows[read.values == end.level]] = True
        told = "; ".join(_in_words(end, read, column) for end in ends)
        span = (float(log.t_s[unread][0]), float(log.t_s[unread][-1]))
        sentence = f"{told}: the axis was under way before and behind, and the sensor's range ends there; left out"
        yield Found(Finding("clipped_sensor", name, column, *span, sentence, EXCLUDE, int(unread.sum())), unread)


def _ends(read: Readings, step: float) -> Iterator[_End]:
    stands = runs(read.values) if len(read.values) else []
    moves = np.abs(np.diff(read.values))
    if not moves.any():
        return
    least = max(float(moves[moves > 0.0].min()), step)
    never_repeats = hardly_repeats(read.values, stands)
    for level, how in ((float(read.values.max()), "exceeds"), (float(read.values.min()), "falls below")):
        own = [stand for stand in stands if read.values[stand[0]] == level]
        judged = [share for stand in own if (share := _evenness(read, *stand, least)) > 0.0]
        even = sum(share > thresholds.EVEN for share in judged)
        if even >= max(thresholds.LEAST_CLIPS, thresholds.MOST_CUT_OFF * len(judged)) or (
            own and never_repeats and level != 0.0
        ):
            yield _End(level, how, own)


def _evenness(read: Readings, first: int, last: int, least: float) -> float:
    """How evenly the column leaves a stand, and comes to it where it may leave it as it likes; 0 where it is not under way on a side."""
    limits = thresholds.CUT_OFF_STEPS * least, min(last - first + 1, max(thresholds.CUT_OFF_ROWS, read.way))
    comes, leaves = evenness(read, first, -1, *limits), evenness(read, last + 1, 1, *limits)
    as_it_likes = not read.has_mass or is_set_going(read.u, first, last, read.way, np.ptp(read.u, axis=0))
    return min(comes, leaves) if as_it_likes or not comes else leaves


def _in_words(end: _End, read: Readings, column: str) -> str:
    spans = ", ".join(
        f"{read.t_s[first]:.6g} s to {read.t_s[last]:.6g} s" for first, last in end.stands[: thresholds.TIMES_SHOWN]
    )
    more = (
        f" and {len(end.stands) - thresholds.TIMES_SHOWN} times more"
        if len(end.stands) > thresholds.TIMES_SHOWN
        else ""
    )
    share = float(np.mean(read.values == end.level))
    level = f"{end.level:.5g} {unit_of(column) or ''}".rstrip()
    return f"{column} never {end.how} {level}, where it stands in {share:.1%} of its rows, from {spans}{more}"
