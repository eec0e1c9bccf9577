"""Angles that no mass could have: as far from row to row as over the whole run.

An input and an output in each other's place: what is called an axis stands and leaps as a command does, while what is called a command
moves as an axis does. No mass leaps from rest to rest within one row, time and again.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain, product

import numpy as np

from logcheck import thresholds
from logcheck.finding import REFUSE, Array, Finding, Found
from logcheck.grid import WHOLE, lies_on, lies_on_none, some
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
    """The first output of an axis that is a staircase, with the first input that is none and changes all along; or one that lies on no
    grid, with the first input that lies on that of its sensor."""
    states = bound.model.axis_states
    of_axes = [output for output, expression in bound.model.outputs.items() if str(expression) in states]
    exchanged = next(chain(_stairs(log, of_axes, bound.plant.sensors), _grids(log, of_axes, bound.plant.sensors)), None)
    if exchanged is None:
        return
    command, output, why = exchanged
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    got = f"{command} and {output} stand in each other's place: {why}"
    expected, remedy = "columns that are what they are called", f"exchange {command} and {output}"
    yield Found(Finding("columns", name, output, *span, got, REFUSE, 0, expected, remedy))


Exchanged = tuple[str, str, str]  # an input, an output, and what tells that each stands in the other's place


def _stairs(log: RunLog, of_axes: Sequence[str], sensors: Mapping[str, float]) -> Iterator[Exchanged]:
    stairs = [output for output in of_axes if _is_a_staircase(log.column(output), sensors.get(output, 0.0))]
    moving = [column for column in log.columns.inputs if _moves_on(log.column(column))]
    for output, command in product(stairs, moving):
        why = f"{output} stands and leaps from row to row as a command does, {command} moves as an axis does"
        yield command, output, why


def _grids(log: RunLog, of_axes: Sequence[str], sensors: Mapping[str, float]) -> Iterator[Exchanged]:
    """Inputs of another unit, as a converter of volts may have one step both ways; of a round decimal, numbers have it by their digits."""
    for output, command in product(of_axes, log.columns.inputs):
        step, unit = sensors.get(output, 0.0), unit_of(output)
        if step <= 0.0 or unit == unit_of(command) or _is_round(step):
            continue
        if lies_on(some(log.column(command)), step) and lies_on_none(some(log.column(output)), step):
            where = f"the grid of {output}'s sensor, {step:.5g} {unit}".rstrip()
            yield command, output, f"{command} lies on {where}, and {output} on none"


def _is_round(step: float) -> bool:
    """Whether a step is a decimal of two digits: 0.001, 0.0015, 0.25."""
    digits = step / 10.0 ** (np.floor(np.log10(step) + WHOLE) - 1.0)
    return bool(abs(digits - round(digits)) < WHOLE)


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
