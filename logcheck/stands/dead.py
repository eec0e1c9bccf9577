"""Readings that stop for a while: an output that stands though its axis goes on, as the jump shows when it is read again.

An axis that slows down, rests and leaves its rest starts by less than it moves next. Where the first move behind a stand is far more than
those after it, the readings between were old. So they were where it came back to where it had been, and no jump shows: an axis that comes
to rest by an even brake goes three times as far in the second last stretch of time as in the last; one that is cut off, as far. This is
asked of positions alone, as nothing brakes a current or a rate, not of an axis that an input sets going as it moves itself, nor of one
that is no faster than it is stopped elsewhere: dry friction and play hold what turns back. A current or a rate that an input sets going
begins with its largest move.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from logcheck import thresholds
from logcheck.finding import EXCLUDE, Array, Finding, Found, Rows
from logcheck.stands.column import (
    Readings,
    comes_back,
    evenness,
    hardly_repeats,
    is_set_going,
    moves_far,
    readings_of,
    runs,
    speed_before,
    usual_change_of_speed,
)
from records.log import RunLog
from records.text.units import unit_of


@dataclass(frozen=True)
class Stand:
    """Rows first..last of one value; by how much the column jumps into it and out of it, and how fast it was: 0 for nothing unusual."""

    first: int
    last: int
    jump_in: float
    jump_out: float
    speed_before: float


def read_again(log: RunLog) -> Rows:
    """Rows (n,) in which the outputs are read again after the link failed: all stood until then, from about the same row on."""
    outputs = [log.column(column) for column in log.columns.outputs]
    stands = [{last: first for first, last in _stands(log.t_s, values)} for values in outputs]
    again: Rows = np.zeros(len(log.t_s), bool)
    for last in set(stands[0]).intersection(*stands[1:]) if len(stands) > 1 else ():
        firsts = [by_last[last] for by_last in stands]
        if last + 1 < len(again) and np.ptp(log.t_s[firsts]) < thresholds.LINK_STOPS_S:
            again[last + 1] = True
    return again


def dead_findings(
    log: RunLog,
    name: str,
    steps: Mapping[str, float],
    begins: Rows,
    positions: Collection[str] = (),
    again: Rows | None = None,
) -> Iterator[Found]:
    """The stands of each output that no axis makes, whose readings are left out; with the rows `begins` (n,) another log begins.

    `positions` are outputs that a mass moves. Where all outputs are read `again` (n,), or the inputs had stood too, the link had failed:
    what follows is another log.
    """
    for column in log.columns.outputs:
        step = steps.get(column, 0.0)
        read = readings_of(log, column, begins, positions)
        t_s, present = read.t_s, read.rows
        stands = list(_dead(read, step))
        if not stands:
            continue
        unread: Rows = np.zeros(len(log.t_s), bool)
        for stand in stands:
            # The first reading of a stand into which nothing jumps is the last true one.
            unread[present[stand.first + (stand.jump_in == 0.0) : stand.last + 1]] = True
        span = (float(t_s[stands[0].first]), float(t_s[stands[-1].last]))
        told = [_in_words(stand, read, column, step) for stand in stands[: thresholds.TIMES_SHOWN]]
        more = (
            f"; and so {len(stands) - thresholds.TIMES_SHOWN} times more, last until {span[1]:.6g} s"
            if len(stands) > thresholds.TIMES_SHOWN
            else ""
        )
        sentence = f"{column} stands {'; '.join(told)}{more}: the sensor was not read; left out"
        other: Rows = np.zeros(len(log.t_s), bool)
        for first, last in ((present[stand.first], present[stand.last]) for stand in stands):
            if last + 1 < len(other):
                other[last + 1] = (again is not None and again[last + 1]) or _all_stood(log.u, first, last)
        if other.any():
            sentence += ", and what follows, where all are read again, is used as another log"
        yield Found(Finding("dead_stretch", name, column, *span, sentence, EXCLUDE, int(unread.sum())), unread, other)


def _all_stood(u: Array, first: int, last: int) -> bool:
    """Whether every input (n, inputs) stood with an output, and one moves far in the row in which it is read again: none was written."""
    return bool(np.all(u[first : last + 1] == u[first])) and moves_far(u[last : last + 2], np.ptp(u, axis=0))


def amount(move: float, column: str, step: float) -> str:
    """A move in steps of the encoder, in the column's own unit where it has none."""
    return f"{move / step:.0f} steps" if step > 0.0 else f"{move:.3g} {unit_of(column) or ''}".rstrip()


def _in_words(stand: Stand, read: Readings, column: str, step: float) -> str:
    t_s = read.t_s
    span = f"at {read.values[stand.first]:.4g} from {t_s[stand.first]:.6g} s to {t_s[stand.last]:.6g} s"
    return f"{span} ({', '.join(_ways(stand, column, step))})"


def _ways(stand: Stand, column: str, step: float) -> Iterator[str]:
    """What shows that the axis did not stand."""
    if stand.jump_in:
        yield f"it jumps there by {amount(stand.jump_in, column, step)}"
    elif stand.speed_before:
        yield f"it moved at {stand.speed_before:.2g} {unit_of(column) or ''} a second just before"
    if stand.jump_out:
        yield f"it jumps away by {amount(stand.jump_out, column, step)}"
    if not stand.jump_in and not stand.jump_out:
        yield "where it hardly ever reads the same twice"


def _dead(read: Readings, step: float) -> Iterator[Stand]:
    """Stands of at least DEAD_ROWS rows into which or out of which the column leaps, by far more than it moves there, though its axis was
    under way, or the inputs moved it; of a mass also those on whose sides it goes on as before."""
    t_s, values, u, way = read.t_s, read.values, read.u, read.way
    moves = np.where(read.begins[1:], 0.0, np.diff(values))
    own = np.abs(moves[moves != 0.0])
    if not own.size:
        return
    least, usual_u = max(float(own.min()), step), np.ptp(u, axis=0)
    # As far as in one sample, where rows lie further apart.
    moves = moves * read.period_s / np.maximum(np.diff(t_s), read.period_s)
    stands = runs(values)
    never_repeats = hardly_repeats(values, stands)
    for begin, end in stands:
        into = float(moves[begin - 1]) if begin else 0.0
        out = float(moves[end]) if end < len(moves) else 0.0
        if never_repeats and values.min() < values[begin] < values.max():  # at an end of its range a sensor may rest
            yield Stand(begin, end, 0.0, 0.0, 0.0)
            continue
        before = moves[max(0, begin - 1 - way) : max(0, begin - 1)]
        after = moves[end + 1 : end + 1 + way]
        arrived = moves[max(0, begin - thresholds.AROUND_STAND_ROWS) : begin]
        leaps_in = _is_leap(into, before[-thresholds.AROUND_STAND_ROWS :], least)
        leaps_out = _is_leap(out, after[: thresholds.AROUND_STAND_ROWS], least)
        arrives = _is_under_way(np.abs(arrived), least)
        until = end + (2 if read.has_mass else 1)  # no mass answers a command in the row that gives it
        driven = moves_far(u[begin:until], usual_u)
        goes_on = arrives or driven or _is_under_way(after * np.sign(out), least)
        set_going = is_set_going(u, begin, end, way, usual_u)
        starts = not read.has_mass and set_going and not arrives  # a rate leaves its rest by its largest move
        leaps = (leaps_in and (leaps_out or _is_under_way(np.abs(before), least))) or (
            leaps_out and goes_on and not starts
        )
        cut_off = read.has_mass and not leaps and _is_cut_off(read, begin, end, least, set_going, stands)
        if cut_off and not arrives:  # so dense are the rows that a few of them tell no speed
            arrived, arrives = moves[max(0, begin - way) : begin], True
        if leaps or cut_off:
            took_s = float(t_s[begin] - t_s[max(0, begin - len(arrived))])
            speed = float(np.abs(arrived).sum()) / took_s if arrives and not leaps_in else 0.0
            yield Stand(begin, end, abs(into) * leaps_in, abs(out) * leaps_out, speed)


def _is_cut_off(
    read: Readings, begin: int, end: int, least: float, set_going: bool, stands: list[tuple[int, int]]
) -> bool:
    """Whether the column is under way up to the stand begin..end, and from it on, as no axis is that comes to rest and leaves it.

    One that an input has `set_going` leaves it as it likes.
    """
    values, way, margin = read.values, read.way, thresholds.BROKEN_OFF_STEPS * least
    if not values.min() + margin < values[begin] < values.max() - margin:
        return False  # at an end of its range an axis may be stopped
    rows = end - begin + 1
    both = thresholds.CUT_OFF_STEPS * least, min(rows, max(thresholds.CUT_OFF_ROWS, way))
    alone = thresholds.CUT_OFF_ALONE_STEPS * least, min(rows // 2, way)
    comes = [evenness(read, begin, -1, *limits) for limits in (both, alone)]
    goes = evenness(read, end + 1, 1, *both)
    on_both_sides = not set_going and _is_even(comes[0]) and _is_even(goes)
    if not on_both_sides and comes[1] <= thresholds.EVEN:
        return False
    if _is_stopped(read, begin, end, margin, stands):
        return False
    return on_both_sides or not _would_have_jumped(read, begin, end, margin, stands)


def _is_even(share: float) -> bool:
    return thresholds.EVEN < share < 1.0 / thresholds.EVEN


def _is_stopped(read: Readings, begin: int, end: int, near: float, stands: list[tuple[int, int]]) -> bool:
    """Whether the axis may well have been stopped, by dry friction or play say: as hard as it is moved elsewhere."""
    return not _jumps(read, end, near) and speed_before(read, begin) < usual_change_of_speed(read, stands)


def _would_have_jumped(read: Readings, begin: int, end: int, near: float, stands: list[tuple[int, int]]) -> bool:
    """Whether the axis stood for so long that, unseen, it would hardly have come back to where it is read again."""
    if end + 1 == len(read.values) or _jumps(read, end, near):
        return False
    return comes_back(read, stands, end + 1 - begin, near) < thresholds.COMES_BACK_SHARE


def _jumps(read: Readings, end: int, near: float) -> bool:
    """Whether it is read again elsewhere."""
    return end + 1 < len(read.values) and abs(float(read.values[end + 1] - read.values[end])) >= near


def _is_leap(move: float, near: Array, least: float) -> bool:
    usual = max(float(np.max(np.abs(near), initial=0.0)), least)
    return abs(move) > thresholds.BROKEN_OFF * usual and abs(move) >= thresholds.BROKEN_OFF_STEPS * least


def _is_under_way(moved: Array, least: float) -> bool:
    return float(moved.sum()) >= thresholds.MOVED_STEPS * least


def _stands(t_s: Array, values: Array) -> list[tuple[int, int]]:
    """First and last rows of one value that is kept for DEAD_S."""
    return [(first, last) for first, last in runs(values) if t_s[last] - t_s[first] >= thresholds.DEAD_S]
