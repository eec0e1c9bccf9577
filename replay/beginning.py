"""First readings that the law did not have: what a logger holds before its sensors are read, or its variables are set.

One wrong reading moves the law's state, and with it every answer behind. If the law had another reading there, its answers tell which.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from records.log import RunLog
from records.table import ControllerTable
from replay import thresholds
from replay.events import Follower, Workshop
from replay.flight import flight_of
from replay.law import Setup


def other_beginnings(log: RunLog, table: ControllerTable) -> Iterator[tuple[RunLog, str]]:
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


def _first_stand(values: np.ndarray) -> int:
    """How many rows a column begins with one value; 0 for more than MOST_UNREAD, and where nothing was read."""
    others = np.flatnonzero(values != values[0])
    rows = int(others[0]) if others.size and np.isfinite(values[0]) else 0
    return rows if rows <= thresholds.MOST_UNREAD else 0


def _sentence(log: RunLog, column: str, rows: int) -> str:
    value = float(log.column(column)[0])
    first = "in the first row" if rows == 1 else f"in the first {rows} rows"
    return f"{column} is {value:.6g} {first}, where the law had another value"
