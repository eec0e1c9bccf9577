"""Angles that no mass could have: as far from row to row as over the whole run.

An input and an output in each other's place: what is called an axis stands and leaps as a command does, while what is called a command
moves as an axis does. No mass leaps from rest to rest within one row, time and again.
"""

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from logcheck import thresholds
from logcheck.finding import REFUSE, Array, Finding, Found
from recordings.mapping.wraps import angle_past_its_end
from records.log import RunLog
from records.text.units import unit_of
from sim.bind import BoundPlant

COUNTER = 2.0**16  # of an encoder's counts, as timers have them


def motion_findings(log: RunLog, name: str, bound: BoundPlant) -> Iterator[Found]:
    """Outputs that are an axis' position and whose rows know nothing of each other: noise, or rows that were shuffled."""
    positions = {str(axis.position) for axis in bound.model.axes if axis.position is not None}
    for column, expression in bound.model.outputs.items():
        read = log.column(column)[np.isfinite(log.column(column))]
        step = bound.plant.sensors.get(column, 0.0)
        if str(expression) not in positions or step <= 0.0 or read.size < 3:
            continue
        usual = float(np.median(np.abs(read - np.median(read))))
        jump = float(np.median(np.abs(np.diff(read))))
        if usual > thresholds.LEAST_MOTION_STEPS * step and jump > thresholds.JUMPS_RATIO * usual:
            span = (float(log.t_s[0]), float(log.t_s[-1]))
            sentence = (
                f"{column} jumps by {jump:.3g} from row to row, as far as it is from its middle: rows without order"
            )
            remedy = f"check the order of the rows and what was read as {column}"
            yield Found(Finding("no_motion", name, column, *span, sentence, REFUSE, 0, "an angle that moves", remedy))


def wrap_findings(log: RunLog, name: str, steps: Mapping[str, float], positions: Collection[str]) -> Iterator[Found]:
    """Positions that are kept within a turn, or in a counter of 16 bits, and leap by all of it where they leave it."""
    for column in log.columns.outputs:
        if column not in positions:
            continue
        values, step = log.column(column), steps.get(column, 0.0)
        turn = [2.0 * np.pi] if unit_of(column) == "rad" else []
        whole, leaps, size = angle_past_its_end(values, [*turn, *([COUNTER * step] if step > 0.0 else [])])
        usual = float(np.nanpercentile(np.abs(np.diff(whole)), thresholds.USUAL_SPEED_PERCENT)) if leaps else 0.0
        if not leaps or np.nanmax(np.abs(np.diff(whole))) > thresholds.SEAM_FASTER * max(usual, step):
            continue
        at = log.t_s[1:][np.abs(np.diff(values)) >= 0.5 * size]
        what = "a turn" if turn and size == turn[0] else "65536 counts"
        sentence = f"{column} leaps by {what} {'once' if leaps == 1 else f'{leaps} times'}, first at {at[0]:.6g} s: it was kept within that"
        expected, remedy = "an angle that is counted on", "`twinlaw import` counts it on"
        yield Found(
            Finding("wrapped", name, column, float(at[0]), float(at[-1]), sentence, REFUSE, 0, expected, remedy)
        )


def exchange_findings(log: RunLog, name: str, bound: BoundPlant) -> Iterator[Found]:
    """The first output of an axis that is a staircase, with the first input that is none and changes all along."""
    states = {str(state) for axis in bound.model.axes for state in (axis.position, axis.velocity)}
    of_axes = [output for output, expression in bound.model.outputs.items() if str(expression) in states]
    sensors = bound.plant.sensors
    stairs = [output for output in of_axes if _is_a_staircase(log.column(output), sensors.get(output, 0.0))]
    moving = [column for column in log.columns.inputs if _moves_on(log.column(column))]
    if not stairs or not moving:
        return
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    got = (
        f"{moving[0]} and {stairs[0]} stand in each other's place: {stairs[0]} stands and leaps from row to row as a command does, "
        f"{moving[0]} moves as an axis does"
    )
    expected, remedy = "columns that are what they are called", f"exchange {moving[0]} and {stairs[0]}"
    yield Found(Finding("columns", name, stairs[0], *span, got, REFUSE, 0, expected, remedy))


def _moves(values: Array) -> tuple[Array, float]:
    """How far a column moves from row to row where it is read, and its range."""
    present = values[np.isfinite(values)]
    return np.abs(np.diff(present)), float(np.ptp(present)) if present.size else 0.0


def _is_a_staircase(values: Array, step: float) -> bool:
    """Whether a column stands in most rows, and leaps by much of its range where it does not; a step of its sensor is no leap, nor one of
    a coarser grid, whose points an axis passes one after the other."""
    moves, whole = _moves(values)
    leaps = moves[moves > 0.0]
    stands = leaps.size <= (1.0 - thresholds.STANDS_SHARE) * moves.size
    far = max(thresholds.LEAPS_SHARE * whole, thresholds.LEAST_SEAM_STEPS * step)
    if not stands or leaps.size < thresholds.LEAST_LEAPS or np.median(leaps) <= far:
        return False
    return bool(leaps.max() > leaps.min() + 2.0 * step or whole < 2.0 * leaps.min())


def _moves_on(values: Array) -> bool:
    """Whether a column changes in many rows, each time by little of its range."""
    moves, whole = _moves(values)
    changes = moves[moves > 0.0]
    often = changes.size > thresholds.CHANGES_SHARE * moves.size
    return bool(often and np.median(changes) < thresholds.CREEPS_SHARE * whole)
