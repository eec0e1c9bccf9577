"""A log made ready for replay: one row per control sample, with what the law saw and what was logged of its answer."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from records.log import RunLog
from records.table import ControllerTable
from records.text.units import units_of
from replay import thresholds
from replay.digits import Printing, printing

Array = NDArray[np.float64]

UNMEASURED_REACH = np.array(
    sorted(range(-6, 7), key=abs)
)  # counts about the line between measured neighbours, nearest first
PRINT_MARGIN = 1.0 + 1e-6


@dataclass(frozen=True, eq=False)
class ReplayedLog:
    """Samples k = 0..n-1: references and angles (n, loops) in rad, logged inputs in V and their rounding `half_step_V`, alike.

    A sample that the log lacks has NaN everywhere, a command that is not known NaN alone; where it lacks too many (`lacking`), rows
    stand as they come.
    `printings` are those of the inputs, of the references and of the angles, each in the order of the loops. Angles that are whole steps
    of their sensor, `in_steps` (loops), are as they were measured: what few digits they have is the sensor's doing.
    """

    t_s: Array
    reference_rad: Array
    angle_rad: Array
    logged_V: Array
    half_step_V: Array
    missing: tuple[tuple[int, int], ...]
    printings: tuple[Printing, ...]
    steps_rad: tuple[float, ...]
    rows: NDArray[np.int64]
    input_names: tuple[str, ...]
    lacking: int
    in_steps: tuple[bool, ...]

    @property
    def reference_half_step_rad(self) -> Array:
        """How far printing may have moved each reference (n, loops): a few numbers tell no digits, those of its angle do, or of its
        input where the angle's are its sensor's."""
        beside = [
            given if steps else angle
            for given, angle, steps in zip(self.input_printings, self.angle_printings, self.in_steps, strict=True)
        ]
        columns = zip(self.reference_rad.T, self.reference_printings, beside, strict=True)
        return np.column_stack(
            [np.maximum(own.half_step(column), other.half_step(column)) for column, own, other in columns]
        )

    @cached_property
    def counted_in_double(self) -> bool:
        """Whether its angles are whole counts multiplied in double precision."""
        steps = np.array(self.steps_rad)
        products = _in_float64(np.round(self.angle_rad / steps), steps).astype(np.float32)
        return np.array_equal(products, self.angle_rad.astype(np.float32), equal_nan=True)

    @property
    def unknown(self) -> NDArray[np.bool_]:
        """Rows (n,) of the log in which a command is not known."""
        unknown: NDArray[np.bool_] = np.asarray(np.isnan(self.logged_V).any(axis=1))
        for first, behind in self.missing:
            unknown[first:behind] = False
        return unknown

    @property
    def unit(self) -> str:
        """Of the inputs."""
        return units_of(self.input_names)

    @property
    def loops(self) -> int:
        """How many loops the law closes."""
        return len(self.input_names)

    @property
    def input_printings(self) -> tuple[Printing, ...]:
        """Those of the inputs."""
        return self.printings[: self.loops]

    @property
    def reference_printings(self) -> tuple[Printing, ...]:
        """Those of the references."""
        return self.printings[self.loops : 2 * self.loops]

    @property
    def angle_printings(self) -> tuple[Printing, ...]:
        """Those of the angles."""
        return self.printings[2 * self.loops :]

    @property
    def inputs_are_rounded(self) -> bool:
        """True where the log wrote the voltages down with fewer digits than a float32 has."""
        return not all(entry.is_exact for entry in self.input_printings)


def has_replayable_columns(log: RunLog, table: ControllerTable) -> bool:
    """True where the log holds input, angle and reference of every loop of the table."""
    return all(
        loop.input in log.columns.inputs and loop.output in log.columns.outputs and loop.reference in log.extra
        for loop in table.loops
    )


def flight_of(log: RunLog, table: ControllerTable) -> ReplayedLog:
    """The log on its control samples; rows that are missing by sequence number or by time are put in as NaN."""
    loops = table.loops
    references = np.column_stack([log.extra[loop.reference] for loop in loops])
    inputs = [log.columns.inputs.index(loop.input) for loop in loops]
    outputs = [log.columns.outputs.index(loop.output) for loop in loops]
    samples, lacking = _samples(log)
    columns = [log.u[:, inputs], references, log.y[:, outputs]]
    n = int(samples[-1]) + 1
    u_V, reference_rad, angle_rad = (_spread(column, samples, n) for column in columns)
    steps_rad = tuple(axis.resolution_rad for axis in table.axes)
    in_steps = tuple(_in_steps(column, step) for column, step in zip(columns[2].T, steps_rad, strict=True))
    angles = (Printing() if steps else printing(column) for column, steps in zip(columns[2].T, in_steps, strict=True))
    written = (*(printing(column) for block in columns[:2] for column in block.T), *angles)
    return ReplayedLog(
        t_s=np.interp(np.arange(n), samples, log.t_s),
        reference_rad=reference_rad,
        angle_rad=angle_rad,
        logged_V=u_V,
        half_step_V=np.column_stack([p.half_step(column) for p, column in zip(written, u_V.T, strict=False)])
        * PRINT_MARGIN,
        missing=blocks(~np.isin(np.arange(n), samples)),
        printings=written,
        steps_rad=steps_rad,
        rows=samples,
        input_names=tuple(loop.input for loop in loops),
        lacking=lacking,
        in_steps=in_steps,
    )


def _in_steps(angle_rad: Array, step_rad: float) -> bool:
    """Whether all angles (n,) are whole steps of their sensor, to the digits of float32: then none was lost in writing them down."""
    if not step_rad:
        return False
    off = np.abs(angle_rad - np.round(angle_rad / step_rad) * step_rad)
    return bool(np.all(np.isnan(off) | (off <= np.spacing(np.abs(angle_rad).astype(np.float32)))))


def readings(flight: ReplayedLog) -> tuple[ReplayedLog, ...]:
    """The flight as logged and, where that is another number, as the whole encoder counts that its angles, and its references if all
    are on the grid, stand for.

    Counts become angles in two ways: multiplied in double precision and then rounded, or in float32 as the firmware does.
    """
    if not all(flight.steps_rad):
        return (flight,)
    steps = np.array(flight.steps_rad)
    found = [flight]
    for product in (_in_float64, _in_float32):
        angles = product(np.round(flight.angle_rad / steps), steps)
        on_grid = [product(np.round(flight.reference_rad / steps), steps), flight.reference_rad]
        references = next(values for values in on_grid if _as_written(values, flight))
        given = np.hstack([references, angles]).astype(np.float32)
        if not any(
            np.array_equal(given, np.hstack([other.reference_rad, other.angle_rad]).astype(np.float32), equal_nan=True)
            for other in found
        ):
            found.append(replace(flight, reference_rad=references, angle_rad=angles))
    return tuple(found)


def _in_float64(counts: Array, steps: Array) -> Array:
    return counts * steps


def _in_float32(counts: Array, steps: Array) -> Array:
    return np.asarray((counts.astype(np.float32) * steps.astype(np.float32)).astype(float))


def _as_written(references: Array, flight: ReplayedLog) -> bool:
    """Whether these references (n, loops) are written down as those that the log holds."""
    half = flight.reference_half_step_rad
    off = np.abs(references - flight.reference_rad)
    return bool(
        np.all(np.isnan(off) | (off <= half * PRINT_MARGIN + np.spacing(np.abs(references).astype(np.float32))))
    )


def _samples(log: RunLog) -> tuple[NDArray[np.int64], int]:
    """Number of the control sample of each row, from 0 up; and how many the log lacks, where they are too many to be put in."""
    in_order = np.arange(len(log.t_s))
    if log.seq is not None:
        samples = log.seq - log.seq[0]
    else:
        samples = np.round((log.t_s - log.t_s[0]) / _period_s(log)).astype(np.int64)
    rises = bool(np.all(np.diff(samples) > 0))
    lacking = int(samples[-1]) + 1 - len(samples)
    if rises and lacking <= thresholds.MOST_MISSING * len(samples):
        return samples, 0
    return in_order, max(lacking, 0) if rises else 0


def _period_s(log: RunLog) -> float:
    """The sample period by the log's own clock, which may run a little fast or slow; that of its sidecar where rows lie further apart."""
    measured_s = float(np.median(np.diff(log.t_s))) if len(log.t_s) > 1 else log.sample_period_s
    return (
        measured_s
        if abs(measured_s - log.sample_period_s) < thresholds.CLOCK_ERROR * log.sample_period_s
        else log.sample_period_s
    )


def _spread(values: Array, samples: NDArray[np.int64], n: int) -> Array:
    spread = np.full((n, values.shape[1]), np.nan)
    spread[samples] = values
    return spread


def blocks(marked: NDArray[np.bool_]) -> tuple[tuple[int, int], ...]:
    """Runs of True as (first, behind last)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(np.int8)))
    return tuple((int(a), int(b)) for a, b in edges.reshape(-1, 2))


def lagged(values: Array, lag: int) -> Array:
    """Row k holds what row k - lag held; beyond an end stands the number at that end."""
    return values[np.clip(np.arange(len(values)) - lag, 0, len(values) - 1)]


def advanced(values: Array, lead: int) -> Array:
    """Row k holds what row k + lead held, NaN where there is none."""
    if lead == 0:
        return values
    result = np.full_like(values, np.nan)
    if lead > 0:
        result[:-lead] = values[lead:]
    else:
        result[-lead:] = values[:lead]
    return result


def candidates_for_missing(flight: ReplayedLog, block: tuple[int, int]) -> Sequence[Array]:
    """What the law may have been given in up to two missing samples: counts near the line between their neighbours.

    Each candidate is (samples, 2 loops): references, then angles; nothing for longer gaps or gaps at an end.
    """
    first, behind = block
    if behind - first > 2 or first == 0 or behind == len(flight.t_s) or not all(flight.steps_rad):
        return ()
    before, after = flight.angle_rad[first - 1], flight.angle_rad[behind]
    if np.isnan(before).any() or np.isnan(after).any():
        return ()
    steps = np.array(flight.steps_rad)
    reach = UNMEASURED_REACH[:5] if behind - first == 1 else UNMEASURED_REACH[:3]
    grids = np.meshgrid(*[reach] * flight.loops, indexing="ij")
    offsets = np.stack(grids, axis=-1).reshape(-1, flight.loops)
    rows = [
        (np.round((before + (after - before) * (k + 1) / (behind - first + 1)) / steps) + offsets) * steps
        for k in range(behind - first)
    ]
    pairs = np.array(np.meshgrid(*[np.arange(len(offsets))] * len(rows), indexing="ij")).reshape(len(rows), -1).T
    angles = [np.stack([row[index] for row, index in zip(rows, pair, strict=True)]) for pair in pairs]
    return [np.hstack([r, angle]) for r in _references_between(flight, block) for angle in angles]


def candidates_for_unmeasured(flight: ReplayedLog, sample: int) -> Sequence[Array]:
    """What the law may have measured in a sample whose angles the log lacks: counts near the line between known ones.

    Each candidate is (1, 2 loops): the sample's references, then angles; those that are known stay as they are.
    """
    steps, known = np.array(flight.steps_rad), flight.angle_rad[sample]
    if not steps.all():
        return ()
    choices = []
    for axis, angles in enumerate(flight.angle_rad.T):
        finite = np.flatnonzero(np.isfinite(angles))
        if np.isfinite(known[axis]) or not finite.size:
            choices.append(known[axis : axis + 1])
            continue
        count = np.round(np.interp(sample, finite, angles[finite]) / steps[axis])
        choices.append((count + UNMEASURED_REACH) * steps[axis])
    grid = np.array(np.meshgrid(*choices, indexing="ij")).reshape(flight.loops, -1).T
    return [np.hstack([flight.reference_rad[sample], angles])[np.newaxis] for angles in grid]


def candidates_for_misread(flight: ReplayedLog, sample: int) -> list[list[Array]]:
    """What the law may have measured in a sample whose angles the log holds otherwise, or lacks: counts near these, by how many of those
    that it holds differ.

    Each candidate is the sample's references, then angles (2 loops,). None is of angles that all moved to where they were a sample
    before: those a law would have kept, unless the log's own `leaps` there.
    """
    steps, near = np.array(flight.steps_rad), flight.angle_rad[max(0, sample - 1) : sample + 3]
    if not steps.all() or sample == 0:
        return []
    held = np.isfinite(flight.angle_rad[sample])
    counts = np.array([_count(column, sample, step) for column, step in zip(flight.angle_rad.T, steps, strict=True)])
    ways = np.round(np.nan_to_num(np.abs(near - near[0])).max(axis=0) / steps)
    ways += UNMEASURED_REACH.max() * leaps(flight, sample)  # as far as a line misses, from wherever the log leapt
    reach = np.clip(ways, UNMEASURED_REACH.max(), thresholds.MISREAD_REACH).astype(int)
    grid = np.meshgrid(*[np.arange(-most, most + 1) for most in reach], indexing="ij")
    moves = np.stack(grid, axis=-1).reshape(-1, flight.loops)
    moves = moves[np.argsort(np.abs(moves).sum(axis=1), kind="stable")]
    moved = (moves != 0) & held
    is_kept = moved.any(axis=1) & np.all(~moved | (counts + moves == np.round(near[0] / steps)), axis=1)
    is_kept &= ~(leaps(flight, sample, 0.0) & moved).any(axis=1)
    moves, moved = moves[~is_kept], moved[~is_kept]
    product = _in_float64 if flight.counted_in_double else _in_float32
    angles = np.where((moves == 0) & held, flight.angle_rad[sample], product(counts + moves, steps))
    rows = np.hstack([np.tile(flight.reference_rad[sample], (len(moves), 1)), angles])
    return [list(rows[moved.sum(axis=1) == count]) for count in range(int(held.all()), int(held.sum()) + 1)]


def leaps(flight: ReplayedLog, sample: int, least_counts: float = thresholds.LINE_COUNTS) -> NDArray[np.bool_]:
    """Which angles (loops,) of the log leave the line between the readings beside them, those of the sample before do not, and come back
    in a few: no firmware that kept a reading makes a sensor do so."""
    if sample == 0 or not all(flight.steps_rad):
        return np.zeros(flight.loops, dtype=bool)
    before, here, *behind = flight.angle_rad[sample - 1 : sample + 1 + thresholds.MISREAD_IN_A_ROW]
    lines = [before + (after - before) / rows for rows, after in enumerate(behind, 2)]
    most = np.array(flight.steps_rad) * least_counts
    away = [np.abs(here - line) > np.abs(before - line) + most for line in lines]  # none of what is not a number
    return np.asarray(np.any(away, axis=0)) if away else np.zeros(flight.loops, dtype=bool)


def _count(angle_rad: Array, sample: int, step_rad: float) -> float:
    """The count that the log holds of a sample, or the one on the line between those beside it."""
    finite = np.flatnonzero(np.isfinite(angle_rad))
    return float(np.round(np.interp(sample, finite, angle_rad[finite]) / step_rad)) if finite.size else 0.0


def _references_between(flight: ReplayedLog, block: tuple[int, int]) -> list[Array]:
    """References of the missing samples: as before, as after, or on the line between."""
    first, behind = block
    before, after = flight.reference_rad[first - 1], flight.reference_rad[behind]
    n = behind - first
    if np.array_equal(before, after):
        return [np.tile(before, (n, 1))]
    share = (np.arange(1, n + 1) / (n + 1))[:, np.newaxis]
    return [np.tile(before, (n, 1)), np.tile(after, (n, 1)), before + (after - before) * share]
