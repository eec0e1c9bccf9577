"""Where a column stands: rows of one value, how evenly it comes to them and leaves them, and whether an input set it going there."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import Array, Rows
from records.log import RunLog


@dataclass(frozen=True, eq=False)
class Readings:
    """The readings of one column, (n,) where it was read: at which `rows` of the log, times, values, inputs (n, inputs), and where another
    log `begins`; `has_mass` of what a mass moves."""

    rows: NDArray[np.int64]
    t_s: Array
    values: Array
    u: Array
    begins: Rows
    period_s: float
    has_mass: bool

    @property
    def way(self) -> int:
        """Over how many rows it is asked what a column does beside a stand."""
        return max(thresholds.WAY_ROWS, round(thresholds.WAY_S / self.period_s))


def readings_of(log: RunLog, column: str, begins: Rows, positions: Collection[str]) -> Readings:
    """Those of a column; with the rows `begins` (n,) another log begins, `positions` are outputs that a mass moves."""
    rows = np.flatnonzero(np.isfinite(log.column(column)))
    period_s, has_mass = log.sample_period_s, column in positions
    return Readings(rows, log.t_s[rows], log.column(column)[rows], log.u[rows], begins[rows], period_s, has_mass)


def runs(values: Array) -> list[tuple[int, int]]:
    """First and last rows of one value that is kept for DEAD_ROWS."""
    changed = np.flatnonzero(np.diff(values) != 0.0)
    first, last = np.concatenate([[0], changed + 1]), np.concatenate([changed, [len(values) - 1]])
    long = last - first >= thresholds.DEAD_ROWS - 1
    return list(zip(first[long].tolist(), last[long].tolist(), strict=True))


def hardly_repeats(values: Array, stands: list[tuple[int, int]]) -> bool:
    """Whether a sensor is so noisy that it hardly ever reads the same twice outside the stands, first and last rows."""
    return _repeats(values, stands) < thresholds.SELDOM and _is_noisy(np.diff(values))


def _repeats(values: Array, stands: list[tuple[int, int]]) -> float:
    """Share of the readings that repeat the one before, outside stands."""
    same = np.diff(values) == 0.0
    for first, last in stands:
        same[first:last] = False
    return float(same.mean())


def _is_noisy(moves: Array) -> bool:
    """Whether readings go to and fro, as those of a noisy sensor, and not those of an encoder."""
    return float(np.mean(moves[1:] * moves[:-1] < 0.0)) > thresholds.TO_AND_FRO


def evenness(read: Readings, at: int, way: int, far: float, most_rows: int) -> float:
    """How fast a column is in the rows next to `at` as a share of how fast it is in as many rows beyond them; 0 for none.

    The rows are as few as it takes to go `far`, `most_rows` at most.
    """
    values = read.values
    if not 0 <= at < len(values):
        return 0.0
    ahead = values[at : at + most_rows + 1] if way > 0 else values[max(0, at - most_rows) : at + 1][::-1]
    reached = np.flatnonzero(np.abs(ahead - values[at]) >= far)
    rows = int(reached[0]) if reached.size else 0
    beyond = at + 2 * way * rows
    if not rows or not 0 <= beyond < len(values) or read.begins[min(at, beyond) + 1 : max(at, beyond) + 1].any():
        return 0.0
    places = [at, at + way * rows, beyond]
    near, further = np.diff(values[places]) / np.diff(read.t_s[places])
    return float(near / further) if near * further > 0.0 else 0.0


def speed_before(read: Readings, at: int) -> float:
    """How fast a column is in the last rows before one."""
    first = max(0, at - read.way)
    return abs(float(read.values[at] - read.values[first])) / max(float(read.t_s[at] - read.t_s[first]), read.period_s)


def usual_change_of_speed(read: Readings, stands: list[tuple[int, int]]) -> float:
    """By how much the speed of a column changes in so many rows at most, but for rows beside its stands and a twentieth of all others."""
    way, stood = read.way, _beside(read, stands)
    if len(stood) <= 2 * way:
        return 0.0
    speed = (read.values[way:] - read.values[:-way]) / np.maximum(read.t_s[way:] - read.t_s[:-way], read.period_s)
    moving = ~(stood[: -2 * way] | stood[way:-way] | stood[2 * way :])
    change = np.abs(speed[way:] - speed[:-way])[moving]
    return float(np.percentile(change, thresholds.USUAL_CHANGES_PERCENT)) if change.size else 0.0


def comes_back(read: Readings, stands: list[tuple[int, int]], rows: int, near: float) -> float:
    """The share of all stretches of so many rows, away from its stands, behind which a column is as `near` to where it was before."""
    stood = _beside(read, stands)
    away = ~(stood[:-rows] | stood[rows:]) if rows < len(stood) else stood[:0]
    moved = np.abs(read.values[rows:] - read.values[:-rows])[away] if away.size else np.zeros(0)
    return float(np.mean(moved <= near)) if moved.size else 0.0


def _beside(read: Readings, stands: list[tuple[int, int]]) -> Rows:
    """The rows of stands and those beside (n,)."""
    stood: Rows = np.zeros(len(read.values), bool)
    for first, last in stands:
        stood[max(0, first - read.way) : last + read.way + 1] = True
    return stood


def is_set_going(u: Array, begin: int, end: int, way: int, usual_u: Array) -> bool:
    """Whether an input (n, inputs) moves far in the last `way` rows of the stand begin..end, and not in those before."""
    return moves_far(u[max(begin, end - way) : end + 2], usual_u) and not moves_far(u[begin : end - way + 1], usual_u)


def moves_far(u: Array, usual_u: Array) -> bool:
    """Whether an input (n, inputs) moves by DRIVEN_SHARE of its range in the log."""
    return len(u) > 0 and bool(np.any(np.ptp(u, axis=0) > thresholds.DRIVEN_SHARE * usual_u))
