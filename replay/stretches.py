"""A log with breaks replayed stretch by stretch: the first from rest, those behind a break from the state that the log tells.

Where rows, or more readings in a row than the law's own answers can tell, are missing, nobody knows the law's state behind. One wrong
first reading, which a logger holds before its sensors are read, moves the state too; if the law had another, its answers tell which.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from logcheck.breaks import gaps
from logcheck.stretches import part
from records.log import RunLog
from records.table import ControllerTable
from records.text.units import units_of
from replay import thresholds
from replay.arithmetic import replayed
from replay.causes.midair import begins_in_flight
from replay.firmware import CLEARED, NOT_FOUND, FirmwareReplay, demand_own, replay_firmware
from replay.flight import flight_of, has_replayable_columns
from replay.follower import UNLOGGED, Follower
from replay.law import Setup
from replay.search import MISSING_ROWS
from replay.workshop import Workshop

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]


@dataclass(frozen=True)
class _Behind:
    """One stretch behind a break: from when to when, and within how many volt the law agrees from `since_s` on; None: not compared."""

    start_s: float
    end_s: float
    since_s: float | None
    within_V: float = 0.0


def replay_stretches(
    log: RunLog, table: ControllerTable, others: Sequence[ControllerTable] = (), begins: Rows | None = None
) -> FirmwareReplay:
    """`replay_firmware` of a log that is cut where rows or readings are missing, and in front of the rows `begins` (n,).

    Where no firmware gives what the log holds from within a stand of a sensor on, the stand's readings are left out: if the law goes on
    behind it, it had others. So are the first ones, where already the first answer differs.
    """
    demand_own(log, table)
    first, _ = found, followed = _by_stretches(log, table, others, begins)
    if found.first_difference_s == log.t_s[0] and found.cause not in CLEARED:
        begun = _otherwise_begun(log, table, others, begins)
        if begun is not None:
            return begun
    told: list[str] = []
    while found.cause == NOT_FOUND and len(told) < thresholds.MOST_STANDS:
        stand = _stand(log, table, found.first_difference_s)
        if stand is None:
            break
        log = stand[0]
        told.append(stand[1])
        found, followed = _by_stretches(log, table, others, begins)
    if not told or found.cause not in CLEARED or not followed:
        return first
    return replace(found, sentence="; ".join([*told, found.sentence or ""]))


def _otherwise_begun(
    log: RunLog, table: ControllerTable, others: Sequence[ControllerTable], begins: Rows | None
) -> FirmwareReplay | None:
    """What clears the firmware if it had another first reading or reference than the log holds; None where nothing does."""
    if not has_replayable_columns(log, table):
        return None
    for other, told in _other_beginnings(log, table):
        found, followed = _by_stretches(other, table, others, begins)
        if followed and (found.bit_exact or found.cause in CLEARED):
            sentence = "; ".join([told, found.sentence or "with it every bit agrees"])
            return replace(found, bit_exact=False, cause=UNLOGGED, sentence=sentence)
    return None


def _other_beginnings(log: RunLog, table: ControllerTable) -> Iterator[tuple[RunLog, str]]:
    """The log without the value at which one column of the law begins, where the law follows it then, and what is to be said of it: an
    angle is not known there, a reference is that of the rows behind."""
    for other, told in _without_first(log, table):
        stopped = Follower(Workshop(flight_of(other, table)), Setup(table)).follow().stopped
        if stopped is None or stopped > thresholds.LOOK_AHEAD:
            yield other, told


def _without_first(log: RunLog, table: ControllerTable) -> Iterator[tuple[RunLog, str]]:
    for loop in table.loops:
        place = log.columns.outputs.index(loop.output)
        rows = _first_stand(log.y[:, place])
        if rows:
            y = log.y.copy()
            y[:rows, place] = np.nan
            yield replace(log, y=y), _sentence(log, loop.output, rows)
        values = log.extra[loop.reference]
        rows = _first_stand(values)
        if rows:
            values = np.concatenate([np.full(rows, values[rows]), values[rows:]])
            yield replace(log, extra={**log.extra, loop.reference: values}), _sentence(log, loop.reference, rows)


def _first_stand(values: Array) -> int:
    """How many rows a column begins with one value; 0 for more than MOST_UNREAD, and where nothing was read."""
    others = np.flatnonzero(values != values[0])
    rows = int(others[0]) if others.size and np.isfinite(values[0]) else 0
    return rows if rows <= thresholds.MOST_UNREAD else 0


def _sentence(log: RunLog, column: str, rows: int) -> str:
    value = float(log.column(column)[0])
    first = "in the first row" if rows == 1 else f"in the first {rows} rows"
    return f"{column} is {value:.6g} {first}, where the law had another value"


def _stand(log: RunLog, table: ControllerTable, at_s: float | None) -> tuple[RunLog, str] | None:
    """The log without the readings of an output that stands where the replay first differs, and its sentence; None where none does."""
    if at_s is None or not has_replayable_columns(log, table):
        return None
    row = int(np.argmin(np.abs(log.t_s - at_s)))
    for loop in table.loops:
        place = log.columns.outputs.index(loop.output)
        y = log.y[:, place]
        same = np.concatenate([[False], y[1:] == y[:-1]])
        for run in _runs(same):
            if run.start <= row <= run.stop and run.stop - run.start > thresholds.MOST_UNREAD:
                left = log.y.copy()
                left[run, place] = np.nan
                times = f"from {log.t_s[run.start]:.6g} s to {log.t_s[run.stop - 1]:.6g} s"
                return replace(log, y=left), f"{loop.output} stands {times}, where the law had other readings"
    return None


def _by_stretches(
    log: RunLog, table: ControllerTable, others: Sequence[ControllerTable], begins: Rows | None
) -> tuple[FirmwareReplay, bool]:
    """What is told of the stretches together, and whether the law is known to agree behind every break."""
    if not has_replayable_columns(log, table):
        return replay_firmware(log, table, others), True
    parts = list(_parts(_as_given(log, table), begins))
    if len(parts) < 2:
        whole = replay_firmware(log, table, others)
        if whole.cause != NOT_FOUND or not parts or parts[0].stop == len(log.t_s):
            return whole, True
    first = replay_firmware(part(log, slice(0, parts[0].stop)), table, others)
    if not first.bit_exact and first.cause not in CLEARED:
        return first, True
    behind = [_behind(part(log, rows), table) for rows in parts[1:]]
    end_s, unit = float(log.t_s[parts[0].stop - 1]), units_of(loop.input for loop in table.loops)
    sentence = f"{_break(log, parts, begins)} behind {end_s:.6g} s; up to there the firmware is cleared"
    sentence += "".join(f", {_in_words(entry, unit)}" for entry in behind)
    if first.sentence is not None:
        sentence = f"{first.sentence}; {sentence}"
    followed = bool(behind) and all(entry.since_s is not None for entry in behind)
    return replace(first, bit_exact=False, cause=MISSING_ROWS, sentence=sentence), followed


def _break(log: RunLog, parts: Sequence[slice], begins: Rows | None) -> str:
    """What ends the first stretch."""
    if len(parts) < 2:
        return "readings are missing"
    row = parts[1].start
    cut = begins is not None and bool(begins[row]) and row == parts[0].stop and not gaps(log.t_s)[row]
    return "another recording begins" if cut else "rows or readings are missing"


def _in_words(entry: _Behind, unit: str) -> str:
    if entry.since_s is None:
        return f"from {entry.start_s:.6g} s to {entry.end_s:.6g} s the law's state is not known"
    within = "to the bit" if entry.within_V == 0.0 else f"within {entry.within_V:g} {unit}"
    return f"from {entry.since_s:.6g} s to {entry.end_s:.6g} s it agrees {within}"


def _as_given(log: RunLog, table: ControllerTable) -> RunLog:
    """The log with no reading in the rows from which on a reference of the law is missing to the end."""
    given = np.all(np.isfinite([log.extra[loop.reference] for loop in table.loops]), axis=0)
    known = np.flatnonzero(given)
    behind = np.arange(len(log.t_s)) > (known[-1] if known.size else len(log.t_s))
    return replace(log, y=np.where(behind[:, None], np.nan, log.y)) if behind.any() else log


def _parts(log: RunLog, begins: Rows | None) -> Iterator[slice]:
    """Stretches of rows without breaks and without long runs of rows that lack a reading."""
    n = len(log.t_s)
    edges = gaps(log.t_s) if begins is None else gaps(log.t_s) | begins
    unread: Rows = np.asarray(np.isnan(log.y).any(axis=1))
    for first, behind in pairwise([0, *np.flatnonzero(edges).tolist(), n]):
        for run in _runs(~_long_runs(unread[first:behind])):
            yield slice(first + run.start, first + run.stop)


def _long_runs(marked: Rows) -> Rows:
    """Runs of True that are longer than MOST_UNREAD."""
    found: Rows = np.zeros(len(marked), bool)
    for run in _runs(marked):
        found[run] = run.stop - run.start > thresholds.MOST_UNREAD
    return found


def _runs(marked: Rows) -> list[slice]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(np.int8)))
    return [slice(int(first), int(behind)) for first, behind in edges.reshape(-1, 2)]


def _behind(log: RunLog, table: ControllerTable) -> _Behind:
    start_s, end_s = float(log.t_s[0]), float(log.t_s[-1])
    if len(log.t_s) < 2:
        return _Behind(start_s, end_s, None)
    flight = flight_of(log, table)
    if not replayed(flight, table).differs.any():
        return _Behind(start_s, end_s, start_s)
    found = begins_in_flight(Workshop(flight), table)
    return _Behind(start_s, end_s, None) if found is None else _Behind(start_s, end_s, *found)
