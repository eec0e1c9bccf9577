"""Which rows of a log count: a part of its time, all but those whose readings are in doubt, and where some are missing, or readings."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from identification import thresholds
from logcheck.breaks import gaps
from logcheck.thresholds import BRIDGED_ROWS, GAP_PERIODS
from records.errors import BadInput
from records.log import RunLog


def trimmed(log: RunLog, begin_s: float, end_s: float) -> RunLog:
    """The rows of a log from `begin_s` to `end_s`; raises BadInput where fewer than two are left."""
    kept = (log.t_s >= begin_s) & (log.t_s <= end_s)
    if kept.sum() < 2:
        whole = f"{log.t_s[0]:g} s to {log.t_s[-1]:g} s"
        raise BadInput(
            "log", "trimming", f"no rows from {begin_s:g} s to {end_s:g} s", f"a part of {whole}", "choose other times"
        )
    extra = {name: values[kept] for name, values in log.extra.items()}
    seq = None if log.seq is None else log.seq[kept]
    return replace(log, t_s=log.t_s[kept], u=log.u[kept], y=log.y[kept], extra=extra, seq=seq)


def without_readings(log: RunLog, rows: NDArray[np.bool_]) -> RunLog:
    """The log with nothing measured in these of its rows (n,); their times and inputs stand."""
    return replace(log, y=np.where(rows[:, None], np.nan, log.y)) if np.any(rows) else log


def behind_missing_rows(log: RunLog) -> NDArray[np.int64]:
    """The rows in front of which others are missing while an input changed: what was commanded there, nobody knows.

    None where rows come at random times: then an input holds from row to row.
    """
    steps = np.diff(log.t_s)
    missing = steps > GAP_PERIODS * np.median(steps)
    if missing.mean() > thresholds.AT_RANDOM:
        return np.zeros(0, np.int64)
    return np.flatnonzero(missing & (np.diff(log.u, axis=0) != 0.0).any(axis=1)) + 1


def read_again(log: RunLog) -> NDArray[np.int64]:
    """The rows in which an output is read again, or at last, behind more readings missing than rows are bridged."""
    found = [np.zeros(0, np.int64)]
    for y in log.y.T:
        rows = np.flatnonzero(np.isfinite(y))
        found.append(rows[gaps(log.t_s[rows])])
        if rows.size and rows[0] > BRIDGED_ROWS:
            found.append(rows[:1])
    return np.unique(np.concatenate(found))
