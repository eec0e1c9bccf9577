"""A log that holds fewer digits than float32: compared as far as these digits tell, by what rounding does to the law's own answers.

The law takes references and angles that the log rounded. How far that moves its answers is found by running it on the same numbers, each
anywhere within its last printed digit.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from records.table import ControllerTable
from replay import thresholds
from replay.arithmetic import replayed_in_float32
from replay.flight import ReplayedLog

Array = NDArray[np.float64]
SEED = 11


def agrees_as_printed(flight: ReplayedLog, table: ControllerTable) -> float | None:
    """By how many volt at most the table's law is off the log, where rounding alone would move it as far; else None."""
    if all(entry.is_exact for entry in flight.printings):
        return None
    rng = np.random.default_rng(SEED)
    own_V = replayed_in_float32(flight, table).u_V
    moved_V = [
        np.abs(replayed_in_float32(_rounded_otherwise(flight, rng), table).u_V - own_V)
        for _ in range(thresholds.ROUNDED_RUNS)
    ]
    off_V = np.abs(flight.logged_V - own_V) - flight.half_step_V
    off_V = np.where(np.isnan(off_V), 0.0, np.maximum(off_V, 0.0))
    farthest, usual = (np.max([reduce(run) for run in moved_V], axis=0) for reduce in (_farthest, _usual))
    holds = np.all(_farthest(off_V) <= thresholds.ROUNDED_FARTHER * farthest + thresholds.SAME_ROUNDING_V)
    holds &= np.all(_usual(off_V) <= thresholds.ROUNDED_FARTHER * usual + thresholds.SAME_ROUNDING_V)
    return float(np.nanmax(np.abs(flight.logged_V - own_V))) if holds else None


def _farthest(off_V: Array) -> Array:
    return np.asarray(off_V.max(axis=0))


def _usual(off_V: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(off_V**2, axis=0)))


def _rounded_otherwise(flight: ReplayedLog, rng: np.random.Generator) -> ReplayedLog:
    """The flight with references and angles anywhere within their last printed digit."""
    halves = [entry.half_step(column) for entry, column in zip(flight.angle_printings, flight.angle_rad.T, strict=True)]
    return replace(
        flight,
        reference_rad=_anywhere(flight.reference_rad, flight.reference_half_step_rad, rng),
        angle_rad=_anywhere(flight.angle_rad, np.column_stack(halves), rng),
    )


def _anywhere(columns: Array, half: Array, rng: np.random.Generator) -> Array:
    """Columns (n, loops) with each number anywhere in its half step, alike; one that stands is rounded alike in all its rows."""
    new = np.concatenate([np.ones((1, columns.shape[1]), bool), columns[1:] != columns[:-1]])
    last = np.maximum.accumulate(np.where(new, np.arange(len(columns))[:, np.newaxis], 0), axis=0)
    drawn = np.take_along_axis(rng.uniform(-1.0, 1.0, columns.shape), last, axis=0)
    return np.asarray(columns + drawn * half)
