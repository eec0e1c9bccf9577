"""Several recordings in one file: where one ends and the next begins, every output leaps, which no motion does."""

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.dead import amount
from logcheck.finding import Array, Finding, Found, Rows
from records.log import RunLog

SHOWN = 3


def seam_findings(log: RunLog, name: str, steps: Mapping[str, float], read_again: Rows) -> Iterator[Found]:
    """Where all outputs that move leap at once, and another recording begins; `read_again` (n,) are rows after a dead stretch of all."""
    if len(log.t_s) < 2:
        return
    moving = [column for column in log.columns.outputs if _moves(log.column(column))]
    if len(moving) < 2:
        return
    passed_s = _passed_s(log, moving)
    rows = ~read_again[1:]
    for column in moving:
        rows &= _leaps(log.column(column), passed_s, log.sample_period_s, steps.get(column, 0.0))
    if rows.any():
        yield _found(log, name, moving, steps, np.flatnonzero(rows) + 1)


def _moves(values: Array) -> bool:
    present = values[np.isfinite(values)]
    return bool(present.size and present.min() < present.max())


def _passed_s(log: RunLog, columns: list[str]) -> Array:
    """Time (n - 1,) since any of the columns last changed, where that is at most LONGEST_HELD_S; else the step's own."""
    values = np.column_stack([log.column(column) for column in columns])
    changed = np.concatenate([[True], (np.diff(values, axis=0) != 0.0).any(axis=1)])
    last = np.maximum.accumulate(np.where(changed, np.arange(len(changed)), 0))[:-1]
    held = log.t_s[:-1] - log.t_s[last] <= thresholds.LONGEST_HELD_S
    return np.asarray(np.where(held, log.t_s[1:] - log.t_s[last], np.diff(log.t_s)))


def _leaps(values: Array, passed_s: Array, period_s: float, step: float) -> Rows:
    """Rows (n - 1,) behind which a column moves far faster than it ever does for longer."""
    speed = np.nan_to_num(np.abs(np.diff(values)) / np.where(passed_s > 0.0, passed_s, np.inf))
    padded = np.pad(speed, thresholds.SEAM_ROWS)
    shifts = [shift for shift in range(2 * thresholds.SEAM_ROWS + 1) if shift != thresholds.SEAM_ROWS]
    near = np.max([padded[shift : shift + len(speed)] for shift in shifts], axis=0)
    usual = np.maximum(near, float(np.percentile(speed, thresholds.USUAL_SPEED_PERCENT)))
    return np.asarray(
        (speed > thresholds.SEAM_FASTER * usual) & (speed * period_s > thresholds.LEAST_SEAM_STEPS * step)
    )


def _found(log: RunLog, name: str, columns: list[str], steps: Mapping[str, float], rows: NDArray[np.int64]) -> Found:
    first = int(rows[0])
    leaps, usual = [], []
    for column in columns:
        moves, unit = np.abs(np.diff(log.column(column))), steps.get(column, 0.0)
        leaps.append(f"{column} by {amount(float(moves[first - 1]), column, unit)}")
        usual.append(amount(float(np.nanpercentile(moves, thresholds.USUAL_SPEED_PERCENT)), column, unit))
    later = [f"{log.t_s[row]:.6g} s" for row in rows[1:SHOWN]]
    more = f" and at {len(rows) - SHOWN} more instants" if len(rows) > SHOWN else ""
    again = f", and so at {', '.join(later)}{more}" if later else ""
    sentence = (
        f"all outputs leap at once between {log.t_s[first - 1]:.6g} s and {log.t_s[first]:.6g} s, {' and '.join(leaps)}, "
        f"where they usually move by no more than {' and '.join(usual)} from row to row{again}: "
        "several recordings in one file; cut apart there"
    )
    span = (float(log.t_s[first]), float(log.t_s[rows[-1]]))
    begins: Rows = np.zeros(len(log.t_s), bool)
    begins[rows] = True
    return Found(Finding("seam", name, None, *span, sentence), begins=begins)
