"""An axis whose reading changes its sign within a log: a decoder set up anew, two files of different conventions joined.

It leaps from y to -y within a row, and goes on as it went, mirrored. No sensor that slips and no other recording does so, but by chance:
these go on from any angle, and the axis in its own direction; where it rests, another recording begins with other inputs. Where it passes
zero nothing leaps: it goes back as fast as it came, from row to row, as no mass does but at a stop.
Which of the two signs is the right one, nothing in the column tells.
"""

from collections.abc import Iterator

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.facts import PlantFacts
from logcheck.finding import REFUSE, Array, Finding, Found, Rows
from logcheck.leaps.seams import new_references
from records.log import RunLog
from records.text.units import unit_of
from sim.bind import BoundPlant

SIDE = int(thresholds.SEAM_ROWS)


def turned_findings(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts) -> Iterator[Found]:
    """Outputs that are an axis' position or speed, and whose sign turns; not where a reference leaps too, as another flight may begin."""
    flights = np.concatenate([[0], np.cumsum(new_references(log, facts.steps))])
    for column, expression in bound.model.outputs.items():
        if str(expression) not in bound.model.axis_states:
            continue
        read = np.isfinite(log.column(column))
        t_s, values = log.t_s[read], log.column(column)[read]
        step = facts.steps.get(column, 0.0)
        rows = _turns(t_s, values, log.u[read], log.sample_period_s, step)
        if column in facts.positions and not _may_be_stopped_at_zero(values, facts.stops.get(column, (0.0, 0.0)), step):
            rows = np.union1d(rows, _turns_at_zero(t_s, values, log.sample_period_s, step))
        rows = rows[flights[read][rows] == flights[read][rows - 1]]
        if rows.size:
            yield _found(name, column, t_s, values, rows)


def _found(name: str, column: str, t_s: Array, values: Array, rows: NDArray[np.int64]) -> Found:
    at = ", ".join(f"{t:.6g} s" for t in t_s[rows[: thresholds.TIMES_SHOWN]])
    more = f" and {len(rows) - thresholds.TIMES_SHOWN} times more" if len(rows) > thresholds.TIMES_SHOWN else ""
    before, behind = values[rows[0] - 1], values[rows[0]]
    leaps = f"from {before:.4g} it leaps to {behind:.4g} {unit_of(column) or ''}".rstrip()
    how = leaps if before * behind < 0.0 else "at 0 it goes back as fast as it came"
    sentence = f"the sign of {column} turns at {at}{more}: {how}, within a row, and goes on mirrored"
    remedy = f"turn the sign of {column} in front of it or behind it, or leave one part out"
    span = (float(t_s[rows[0]]), float(t_s[rows[-1]]))
    return Found(Finding("sign_turns", name, column, *span, sentence, REFUSE, 0, "one sign in all rows", remedy))


def _turns(t_s: Array, values: Array, u: Array, period_s: float, step: float) -> NDArray[np.int64]:
    """The rows whose reading is minus what it would be if the axis went on."""
    if len(values) < 2 * SIDE + 2:
        return np.zeros(0, np.int64)
    moves, passed_s = np.diff(values), np.diff(t_s)
    near = _largest_beside(np.abs(moves) / passed_s) * passed_s
    leaps = np.abs(moves) > np.maximum(thresholds.SEAM_FASTER * near, thresholds.LEAST_SEAM_STEPS * step)
    leaps &= passed_s < (thresholds.BRIDGED_ROWS + 1.5) * period_s  # beyond it, the axis may be anywhere
    to_its_mirror = leaps & (np.abs(values[1:] + values[:-1]) <= near + step)
    rows = np.flatnonzero(to_its_mirror[SIDE:-SIDE]) + SIDE + 1
    came, went = values[rows - 1] - values[rows - 1 - SIDE], values[rows + SIDE] - values[rows]
    is_moving = np.minimum(np.abs(came), np.abs(went)) > 0.5 * SIDE * near[rows - 1]
    # Where it turns about, its direction tells nothing.
    is_moving &= _is_even(values, rows - 1, -2) & _is_even(values, rows, 2)
    is_mirrored = np.abs(came + went) < thresholds.MIRRORED * np.abs(came - went)
    return np.asarray(rows[np.where(is_moving, is_mirrored, _go_on(u)[rows - 1])])


def _may_be_stopped_at_zero(values: Array, stops: tuple[float, float], step: float) -> bool:
    """Whether the plant has no stops on either side of zero, and nothing is read on one side of it: there may be a stop."""
    margin = thresholds.BEYOND_STOP_rad
    is_between = stops[0] < -margin and margin < stops[1]
    beyond = min(float(np.max(values, initial=0.0)), -float(np.min(values, initial=0.0)))
    return not is_between and beyond < thresholds.LEAST_SEAM_STEPS * step


def _turns_at_zero(t_s: Array, values: Array, period_s: float, step: float) -> NDArray[np.int64]:
    """The rows of a position from which on it is mirrored where it passes zero: it comes and goes evenly for SIDE rows, as fast, and by as
    much from the row in front to the mirror of this one."""
    if len(values) < 2 * SIDE + 2:
        return np.zeros(0, np.int64)
    moves = sliding_window_view(np.diff(values), SIDE)
    rows = np.arange(SIDE + 1, len(values) - SIDE)
    came, went, passes = moves[rows - 1 - SIDE], -moves[rows], -(values[rows] + values[rows - 1])
    usual = np.mean(came, axis=1)
    off = thresholds.SEAM_EVEN * np.abs(usual)
    turns = (np.abs(np.column_stack([came, went, passes]) - usual[:, None]) <= off[:, None]).all(axis=1)
    turns &= np.abs(usual) * SIDE > thresholds.LEAST_SEAM_STEPS * step
    turns &= t_s[rows + SIDE] - t_s[rows - 1 - SIDE] < (2 * SIDE + thresholds.GAP_PERIODS) * period_s
    found = rows[turns]
    return np.asarray(found[np.diff(found, prepend=-1) > 1])


def _is_even(values: Array, rows: NDArray[np.int64], two: int) -> Rows:
    """Whether the column goes half as far in the `two` rows next to each of the rows as in the two beyond, and more."""
    near, beyond = values[rows + two] - values[rows], values[rows + 2 * two] - values[rows + two]
    return np.asarray(near * beyond >= 0.5 * beyond**2)


def _largest_beside(speeds: Array) -> Array:
    """The largest (n, ...) of those of the SIDE rows before and behind, without the row's own."""
    padded = np.pad(speeds, [(SIDE, SIDE)] + [(0, 0)] * (speeds.ndim - 1))
    return np.asarray(np.max([padded[at : at + len(speeds)] for at in range(2 * SIDE + 1) if at != SIDE], axis=0))


def _go_on(u: Array) -> Rows:
    """Steps (n - 1,) between rows over which every input (n, inputs) moves as it does beside, as it usually does, or by little of its
    range."""
    moves = np.abs(np.diff(u, axis=0))
    often = np.percentile(moves, thresholds.USUAL_SPEED_PERCENT, axis=0)
    usual = np.maximum(_largest_beside(moves), np.maximum(often, thresholds.DRIVEN_SHARE * np.ptp(u, axis=0)))
    return np.asarray((moves <= usual).all(axis=1))
