"""Several recordings in one file: where one ends and the next begins, outputs leap, which no motion does.

Where every output leaps, that is enough. Where one does and the others happen to stand where they stood, its sensor may have slipped: but a
slip moves no reference, no input in an open loop, and leads back to the log's first row by no chance;
and it makes no axis faster or slower. Where none of it tells, both are said.
"""

from collections.abc import Collection, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import Array, Finding, Found, Rows
from logcheck.stands.column import runs
from logcheck.stands.dead import amount
from records.log import RunLog
from sim.columns import reference_name


def seam_findings(
    log: RunLog, name: str, steps: Mapping[str, float], read_again: Rows, positions: Collection[str] = ()
) -> Iterator[Found]:
    """Where another recording begins; `read_again` (n,) are rows after a dead stretch of all, `positions` outputs that a mass moves."""
    if len(log.t_s) < 2:
        return
    moving = [column for column in log.columns.outputs if _moves(log.column(column))]
    if not moving:
        return
    passed_s, apart_s = _passed_s(log, moving), np.diff(log.t_s)
    near = {column: _leaps(log, column, passed_s, steps, 0.0) for column in moving}
    usual = thresholds.USUAL_SPEED_PERCENT
    alone = _alone({column: _leaps(log, column, passed_s, steps, usual) for column in moving}, log, positions)
    at_once = _alone({column: _leaps(log, column, apart_s, steps, 0.0) for column in moving}, log, positions)
    rows: Rows = np.zeros(len(log.t_s) - 1, bool)
    if len(moving) > 1:
        rows |= np.all(list(near.values()), axis=0)
    rows |= alone & (_new_inputs(log) | _new_motion(log, positions, steps))
    rows &= ~read_again[1:]
    rows |= at_once & (new_references(log, steps) | _as_at_first(log, steps))  # at rest a rig stands too before
    rows &= ~behind_lost_times(log)[1:]
    if rows.any():
        first = int(np.argmax(rows))
        leaping = [column for column in moving if _leaps(log, column, apart_s, steps, 0.0)[first]]
        yield _found(log, name, leaping, len(leaping) == len(moving) > 1, steps, np.flatnonzero(rows) + 1)
    for column in (column for column in moving if column in positions):
        lone = _beside_stands(_leaps(log, column, passed_s, steps, usual), log.column(column))
        lone &= ~(rows | read_again[1:] | behind_lost_times(log)[1:])
        if lone.any():
            yield _either(log, name, column, int(np.argmax(lone)) + 1, steps)


def behind_lost_times(log: RunLog) -> Rows:
    """Rows (n,) in front of which more rows went back in time, and were left out, than a filter can bridge: another log begins there."""
    went_back = log.mended.disordered.went_back if log.mended.disordered else ()
    return np.isin(log.t_s, [at_s for at_s, rows in went_back if rows > thresholds.BRIDGED_ROWS])


def _beside_stands(leaps: Rows, values: Array) -> Rows:
    """The leaps (n - 1,) of a column but for those into or out of a stand, of which dead stretches tell."""
    kept = leaps.copy()
    for first, last in runs(values):
        kept[[max(0, first - 1), min(last, len(leaps) - 1)]] = False
    return kept


def _either(log: RunLog, name: str, column: str, row: int, steps: Mapping[str, float]) -> Found:
    at_s, move = float(log.t_s[row]), abs(float(log.column(column)[row] - log.column(column)[row - 1]))
    sentence = (
        f"{column} alone leaps at {at_s:.6g} s, by {amount(move, column, steps.get(column, 0.0))}: its sensor slipped, or another "
        "recording begins there; nothing else in the log tells which, and it is used as one"
    )
    return Found(Finding("lone_leap", name, column, at_s, at_s, sentence))


def _alone(leaps: Mapping[str, Rows], log: RunLog, positions: Collection[str]) -> Rows:
    """Rows (n - 1,) behind which a position leaps, and not into a stand and out of it."""
    own = [_not_back(leaps[column], log.column(column)) for column in leaps if column in positions]
    return np.any(own, axis=0) if own else np.zeros(len(log.t_s) - 1, bool)


def _new_motion(log: RunLog, positions: Collection[str], steps: Mapping[str, float]) -> Rows:
    """Rows (n - 1,) across which a position is suddenly faster or slower, which no slip of a sensor does to it or to another."""
    new: Rows = np.zeros(len(log.t_s) - 1, bool)
    rows = thresholds.SEAM_ROWS
    if len(log.t_s) < 4 * rows:
        return new
    for column in (name for name in log.columns.outputs if name in positions):
        speed = (log.column(column)[rows:] - log.column(column)[:-rows]) / (log.t_s[rows:] - log.t_s[:-rows])
        change = np.abs(np.nan_to_num(speed[rows + 1 :] - speed[: -rows - 1]))  # across one step between both
        usual = float(np.percentile(change, thresholds.USUAL_SPEED_PERCENT))
        least = thresholds.LEAST_SEAM_STEPS * steps.get(column, 0.0) / (rows * log.sample_period_s)
        new[rows:-rows] |= change > max(thresholds.SEAM_KINK * usual, least)
    return new


def _not_back(leaps: Rows, values: Array) -> Rows:
    """The leaps (n - 1,) of a column but for those into and out of a stand: there it was not read."""
    kept = leaps.copy()
    for first, last in runs(values):
        if first and last < len(leaps) and leaps[first - 1] and leaps[last]:
            kept[[first - 1, last]] = False
    return kept


def new_references(log: RunLog, steps: Mapping[str, float]) -> Rows:
    """Rows (n - 1,) behind which a reference leaps, of which one that goes on has none."""
    new: Rows = np.zeros(len(log.t_s) - 1, bool)
    for column in log.columns.outputs:
        reference = reference_name(column)
        if reference in log.extra:
            new |= _leaps(log, reference, np.diff(log.t_s), {reference: steps.get(column, 0.0)}, 0.0)
    return new


def _new_inputs(log: RunLog) -> Rows:
    """Rows (n - 1,) behind which, in an open loop, an input leaps by more than it usually moves."""
    moves = np.abs(np.diff(log.u, axis=0))
    usual = np.percentile(moves, thresholds.USUAL_SPEED_PERCENT, axis=0)
    far = (moves > thresholds.DRIVEN_SHARE * np.ptp(log.u, axis=0)) & (moves > usual)
    return np.asarray(far.any(axis=1) & (log.loop == "open"))


def _as_at_first(log: RunLog, steps: Mapping[str, float]) -> Rows:
    """Rows (n - 1,) behind which every output and every input is what it was in the log's first row, and was not just before."""
    of_outputs, of_inputs = (
        thresholds.BESIDE_FIRST_SHARE
        * (np.nanmax(values, axis=0, initial=-np.inf) - np.nanmin(values, axis=0, initial=np.inf))
        for values in (log.y, log.u)
    )
    beside = [
        max(thresholds.BESIDE_FIRST_STEPS * steps.get(column, 0.0), own)
        for column, own in zip(log.columns.outputs, of_outputs.tolist(), strict=True)
    ]
    with np.errstate(invalid="ignore"):
        there = (np.abs(log.y - log.y[0]) <= beside).all(axis=1) & (np.abs(log.u - log.u[0]) <= of_inputs).all(axis=1)
    return np.asarray(there[1:] & ~there[:-1])


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


def _leaps(log: RunLog, column: str, passed_s: Array, steps: Mapping[str, float], usual_percent: float) -> Rows:
    """Rows (n - 1,) behind which a column moves far faster, in the times `passed_s` (n - 1,), than just before and behind, and than
    that percentile of its speeds."""
    speed = np.nan_to_num(np.abs(np.diff(log.column(column))) / np.where(passed_s > 0.0, passed_s, np.inf))
    padded = np.pad(speed, thresholds.SEAM_ROWS)
    shifts = [shift for shift in range(2 * thresholds.SEAM_ROWS + 1) if shift != thresholds.SEAM_ROWS]
    near = np.max([padded[shift : shift + len(speed)] for shift in shifts], axis=0)
    usual = np.maximum(near, float(np.percentile(speed, usual_percent)))
    far = speed * log.sample_period_s > thresholds.LEAST_SEAM_STEPS * steps.get(column, 0.0)
    return np.asarray((speed > thresholds.SEAM_FASTER * usual) & far)


def _found(
    log: RunLog, name: str, columns: list[str], are_all: bool, steps: Mapping[str, float], rows: NDArray[np.int64]
) -> Found:
    first = int(rows[0])
    leaps, usual = [], []
    for column in columns:
        moves, unit = np.abs(np.diff(log.column(column))), steps.get(column, 0.0)
        leaps.append(f"{column} by {amount(float(moves[first - 1]), column, unit)}")
        usual.append(amount(float(np.nanpercentile(moves, thresholds.USUAL_SPEED_PERCENT)), column, unit))
    later = [f"{log.t_s[row]:.6g} s" for row in rows[1 : thresholds.TIMES_SHOWN]]
    more = f" and at {len(rows) - thresholds.TIMES_SHOWN} more instants" if len(rows) > thresholds.TIMES_SHOWN else ""
    again = f", and so at {', '.join(later)}{more}" if later else ""
    who = "all outputs leap at once" if are_all else "the log leaps"
    sentence = (
        f"{who} between {log.t_s[first - 1]:.6g} s and {log.t_s[first]:.6g} s, {' and '.join(leaps)}, "
        f"where they usually move by no more than {' and '.join(usual)} from row to row{again}: "
        "several recordings in one file; cut apart there"
    )
    span = (float(log.t_s[first]), float(log.t_s[rows[-1]]))
    begins: Rows = np.zeros(len(log.t_s), bool)
    begins[rows] = True
    return Found(Finding("seam", name, None, *span, sentence), begins=begins)
