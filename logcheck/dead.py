"""Readings that stop for a while: an output that stands though its axis goes on, as the jump shows when it is read again."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from logcheck import thresholds
from logcheck.finding import Array, Finding, Found, Rows
from records.log import RunLog
from records.text.units import unit_suffix


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


def dead_findings(log: RunLog, name: str, again: Rows, steps: Mapping[str, float]) -> Iterator[Found]:
    """A note for each stand that no axis makes: one that slows down, rests and leaves its rest makes no jump. `again` is `read_again`."""
    for column in log.columns.outputs:
        for stand in _dead(log.t_s, log.column(column), log.sample_period_s, again):
            start_s, end_s = float(log.t_s[stand.first]), float(log.t_s[stand.last])
            place = f"{column} stands at {log.column(column)[stand.first]:.4g} from {start_s:.6g} s to {end_s:.6g} s"
            how = ", ".join(_ways(stand, column, steps.get(column, 0.0)))
            yield Found(
                Finding("dead_stretch", name, column, start_s, end_s, f"{place}: {how}; the sensor was not read")
            )


def amount(move: float, column: str, step: float) -> str:
    """A move in steps of the encoder, in the column's own unit where it has none."""
    return f"{move / step:.0f} steps" if step > 0.0 else f"{move:.3g} {unit_suffix(column) or ''}".rstrip()


def _ways(stand: Stand, column: str, step: float) -> Iterator[str]:
    """What shows that the axis did not stand."""
    if stand.jump_in:
        yield f"it jumps there by {amount(stand.jump_in, column, step)}"
    elif stand.speed_before:
        yield f"it moved at {stand.speed_before:.2g} {unit_suffix(column) or ''}/s just before"
    if stand.jump_out:
        yield f"it jumps away by {amount(stand.jump_out, column, step)}"


def _dead(t_s: Array, values: Array, period_s: float, again: Rows) -> list[Stand]:
    stands, moves = _stands(t_s, values), np.abs(np.diff(values))
    own = moves[moves > 0.0]
    if not stands or not own.size:
        return []
    least = float(own.min())
    jump = max(
        thresholds.DEAD_JUMP * float(np.nanpercentile(moves, thresholds.USUAL_MOVE_PERCENT)),
        thresholds.DEAD_JUMP_STEPS * least,
    )
    lengths_s = [float(t_s[last] - t_s[first]) for first, last in stands]
    longest_s, second_s = sorted([0.0, thresholds.DEAD_S, *lengths_s])[:-3:-1]
    found = []
    for (first, last), length_s in zip(stands, lengths_s, strict=True):
        into = _jump(t_s, values, first, period_s, jump)
        out = _jump(t_s, values, last + 1, period_s, jump)
        speed = 0.0 if into else _speed_before(t_s, values, first, least)
        is_dead = (
            length_s == longest_s > thresholds.LONGER_STAND * second_s
            or bool(again[last + 1 : last + 2].any())
            or speed > 0.0
        )
        if (into and out) or ((into or out) and is_dead):
            found.append(Stand(first, last, into, out, speed))
    return found


def _stands(t_s: Array, values: Array) -> list[tuple[int, int]]:
    """First and last rows of one value that is kept for DEAD_S."""
    changed = np.flatnonzero(np.diff(values) != 0.0)
    first, last = np.concatenate([[0], changed + 1]), np.concatenate([changed, [len(values) - 1]])
    long = (t_s[last] - t_s[first] >= thresholds.DEAD_S) & (last - first >= thresholds.DEAD_ROWS)
    return list(zip(first[long].tolist(), last[long].tolist(), strict=True))


def _jump(t_s: Array, values: Array, row: int, period_s: float, least: float) -> float:
    """By how much the values jump into a row, in the time of a sample; 0 where they do not."""
    if not 0 < row < len(values):
        return 0.0
    move = float(abs(values[row] - values[row - 1]))
    return move if move * period_s > least * max(float(t_s[row] - t_s[row - 1]), period_s) else 0.0


def _speed_before(t_s: Array, values: Array, row: int, least: float) -> float:
    """How fast the values moved before they stood at `row`, per second; 0 where that is slow."""
    start = int(np.searchsorted(t_s, t_s[row] - thresholds.BEFORE_STAND_S))
    moved = float(abs(values[row] - values[start]))
    return moved / float(t_s[row] - t_s[start]) if start < row and moved >= thresholds.MOVED_STEPS * least else 0.0
