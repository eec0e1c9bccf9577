"""Integers that are too narrow: the command, the law's sum or a measured angle wraps round, or stays at the end of its range.

Where an integer wraps, the log differs from the replay by whole multiples of one range, and in no other sample:

    u_logged = u - n W,   n = floor((u - low) / W)

An integer that saturates stays at its end instead. The range is read off the log; whether it explains the log is for the run to show.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from records.table import ControllerTable
from records.text.units import units_of
from replay import law, thresholds
from replay.flight import ReplayedLog
from replay.law import Channel, Each, Fold, Overflow, ReplayLaw, Setup
from replay.variants import Variant, grid_step, steps_in_words

Array = NDArray[np.float64]

SAME = 2e-6
ANGLE_OVERFLOWS = (
    ("angle_wraps", -0.5, False, "wrap round (signed)"),
    ("angle_wraps", 0.0, False, "wrap round (unsigned)"),
    ("angle_saturates", -0.5, True, "saturate (signed)"),
)


@dataclass(frozen=True)
class Wrap:
    """A range of `span` from `low` up in which a number wraps round."""

    low: float
    span: float


def output_wraps(own_V: Array, logged_V: Array, flight: ReplayedLog) -> Iterator[Variant]:
    """The range in which the logged inputs (n, loops) wrap round, read off against what the law answers, alike."""
    names, digits_V = flight.input_names, np.nanmax(flight.half_step_V, axis=0)
    steps = [grid_step(column) for column in logged_V.T]
    found = [output_wrap(*columns) for columns in zip(own_V.T, logged_V.T, steps, digits_V, strict=True)]
    if not any(found):
        return
    ranges = [wrap or Wrap(0.0, 0.0) for wrap in found]
    clauses = [in_words(name, wrap) for name, wrap in zip(names, found, strict=True) if wrap is not None]
    channel = Channel(wrap_low_V=tuple(wrap.low for wrap in ranges), wrap_span_V=tuple(wrap.span for wrap in ranges))
    sentence = f"lets an integer overflow: {'; '.join(clauses)}"
    yield Variant("output_wraps", "channel", sentence, partial(replace, channel=channel))
    if any(steps):
        for rounding in law.ROUNDINGS:
            on_grid = replace(channel, step_V=tuple(steps), rounding=rounding)
            stepped = f"{sentence}; it sends its answers in steps of {steps_in_words(names, steps)}"
            yield Variant("output_wraps", "channel", stepped, partial(replace, channel=on_grid))


def in_words(name: str, wrap: Wrap) -> str:
    """The range as a person says it."""
    low, high, unit = wrap.low, wrap.low + wrap.span, units_of([name])
    if math.isclose(-low, high):
        return f"{name} wraps round at +-{high:.7g} {unit}"
    return f"{name} wraps round from {high:.7g} {unit} to {low:.7g} {unit}"


def output_wrap(own_V: Array, logged_V: Array, step_V: float, digits_V: float) -> Wrap | None:
    """The range of one input's wrap, logged to within `digits_V`; None where the differences are not multiples of one voltage."""
    off = own_V - logged_V
    off = off[np.isfinite(off) & (np.abs(off) > thresholds.LEAST_WRAP_V)]
    if not off.size:
        return None
    least = float(np.abs(off).min())
    multiple = np.round(off / least)
    if np.abs(off / multiple - least).max() > thresholds.RANGE_TOLERANCE * least:
        return None
    span = _sharpened(float(np.median(off / multiple)), step_V, digits_V)
    if off.size < thresholds.LEAST_WRAPPED and not _is_of_an_integer(span):
        return None
    low = _lower_end(logged_V, span)
    return None if low is None else Wrap(low, span)


def _sharpened(span: float, step_V: float = 0.0, digits_V: float = 0.0) -> float:
    """The range as whole steps of the log's grid, or as the range of an integer where it is one but for rounding."""
    if step_V > 0.0:
        return step_V * round(span / step_V)
    return next((value for value in _integer_ranges(span) if abs(value - span) < SAME * span + 2.0 * digits_V), span)


def _integer_ranges(near: float) -> Iterator[float]:
    """Ranges that integers have which count in powers of ten of a volt, or of its half, a quarter...: 2^n 10^-m, the nearest of each m."""
    if near <= 0.0:
        return
    for decimals in range(thresholds.DECIMALS + 1):
        yield 2.0 ** round(math.log2(near * 10.0**decimals)) / 10.0**decimals


def _is_of_an_integer(span: float) -> bool:
    return any(abs(value - span) < SAME * span for value in _integer_ranges(span))


def _lower_end(logged_V: Array, span: float) -> float | None:
    """Where the range begins: about zero or at zero where the log allows it, else at the roundest number that it allows."""
    low, high = float(np.nanmin(logged_V)), float(np.nanmax(logged_V))
    rounded = (math.floor(low * 10.0**decimals) / 10.0**decimals for decimals in range(thresholds.DECIMALS + 1))
    for begin in (-span / 2.0, 0.0, *rounded, low):
        if begin <= low + SAME * span and high <= begin + span * (1.0 + SAME):
            return begin
    return None


def sums_that_overflow(table: ControllerTable, flight: ReplayedLog, inputs: NDArray[np.float32]) -> Iterator[Variant]:
    """The law's own sum, or its command before the limits, in an integer that is too narrow.

    Its end lies between the greatest number before the first difference and that in it.
    """
    replay, names = ReplayLaw(Setup(table)), [loop.axis for loop in table.loops]
    off_V = replay.outputs(inputs) - flight.logged_V
    differs = np.abs(off_V) > flight.half_step_V + thresholds.LEAST_WRAP_V
    rows = np.flatnonzero(differs.any(axis=1))
    if not rows.size or rows[0] == 0:
        return
    sites = replay.sums(inputs, int(rows[0]) + 1)
    whats = ((law.AT_SUM, "sum"), (law.AT_COMMAND, "command before its limits"))
    for axis in np.flatnonzero(differs[rows[0]]).tolist():
        for (at, what), numbers_V in zip(whats, sites, strict=True):
            for axes in dict.fromkeys(((axis,), tuple(range(len(names))))):
                whose = " and ".join(names[index] for index in axes)
                places = tuple(index in axes for index in range(len(names)))
                place = _Place(places, at, f"{whose} {what}", units_of([flight.input_names[axis]]))
                yield from _overflows(numbers_V[:, axis], abs(float(off_V[rows[0], axis])), place)


@dataclass(frozen=True)
class _Place:
    axes: tuple[bool, ...]
    at: int
    what: str
    unit: str

    def variant(self, kind: int, low_V: float, span_V: float) -> Variant:
        """The law with an integer of this range in this place."""
        name, verb = ("sum_wraps", "wraps round") if kind == law.OVERFLOW_WRAPS else ("sum_saturates", "saturates")
        ends = (
            f"at +-{-low_V:.7g} {self.unit}" if low_V < 0.0 else f"below 0 {self.unit} to the top of an unsigned range"
        )
        if low_V < 0.0 and not math.isclose(span_V, -2.0 * low_V):
            ends = f"at {low_V:.7g} {self.unit} and {low_V + span_V:.7g} {self.unit}"
        overflow = Overflow(kind, self.at, self._there(low_V), self._there(span_V))
        sentence = f"lets an integer overflow: the {self.what} {verb} {ends}"
        return Variant(name, "overflow", sentence, partial(replace, overflow=overflow))

    def _there(self, value_V: float) -> Each:
        return tuple(value_V if there else 0.0 for there in self.axes)


def _overflows(numbers_V: Array, off_V: float, place: _Place) -> Iterator[Variant]:
    """What the numbers up to the first difference, and how much the log is off in it, allow."""
    before, reached = float(np.abs(numbers_V[:-1]).max()), float(abs(numbers_V[-1]))
    for end in _ends(before, reached, off_V / 2.0):
        yield place.variant(law.OVERFLOW_WRAPS, -end, 2.0 * end)
    for low, high in _ends_of_rest(before, reached, reached - off_V):
        yield place.variant(law.OVERFLOW_SATURATES, low, high - low)
    if numbers_V[-1] < 0.0 <= float(numbers_V[:-1].min()):
        for span in dict.fromkeys((_sharpened(off_V), *thresholds.UNSIGNED_V)):
            yield place.variant(law.OVERFLOW_WRAPS, 0.0, span)


def _ends(before: float, reached: float, seen: float) -> list[float]:
    """Ends of a range from `before` to `reached`: as the log shows it, those of integers, and the roundest number."""
    ends = [_sharpened(2.0 * seen) / 2.0, *(value / 2.0 for value in _integer_ranges(2.0 * reached))]
    exponent = math.floor(math.log10(reached)) if reached > 0.0 else 0
    ends += _first(_between(before, reached, 10.0 ** (digits - 1 - exponent)) for digits in thresholds.DECIMAL_DIGITS)
    ends += _first(_between(before, reached, 2.0**bits) for bits in thresholds.FRACTION_BITS)
    return [end for end in dict.fromkeys(ends) if before <= end <= reached]


def _ends_of_rest(before: float, reached: float, seen: float) -> Iterator[tuple[float, float]]:
    """Both ends at which a number may saturate: alike, or as those of an integer, whose lower end is one unit farther from zero."""
    yield from ((-end, end) for end in _ends(before, reached, seen))
    for bits in thresholds.FRACTION_BITS:
        unit = 2.0**-bits
        end = unit * round(seen / unit)
        if abs(end - seen) < SAME * (1.0 + reached):
            yield from ((-end - unit, end), (-end, end + unit))


def _first(found: Iterator[float | None]) -> list[float]:
    return [value for value in found if value is not None][:1]


def _between(before: float, reached: float, per_unit: float) -> float | None:
    end = math.ceil(before * per_unit) / per_unit
    return end if end <= reached else None


def angles_that_wrap(table: ControllerTable, flight: ReplayedLog) -> Iterator[Variant]:
    """Encoder counts in an integer that is too narrow, for the angles of the log that leave its range."""
    names = [loop.axis for loop in table.loops]
    all_of_them = tuple(range(len(names)))
    for bits in thresholds.ANGLE_BITS:
        for name, low, saturates, how in ANGLE_OVERFLOWS:
            columns = zip(flight.angle_rad.T, flight.steps_rad, strict=True)
            folds = [_fold(angle, step, step * 2.0**bits, low, saturates) for angle, step in columns]
            for only in dict.fromkeys((all_of_them, *((axis,) for axis in all_of_them))):
                chosen = [folds[axis] if axis in only else None for axis in all_of_them]
                if any(fold is None for axis, fold in enumerate(chosen) if axis in only):
                    continue
                whose = " and the ".join(names[axis] for axis in only)
                sentence = f"lets an integer overflow: the {whose} counts {how} in {bits} bits"
                yield Variant(name, "folds", sentence, partial(replace, folds=tuple(chosen)))


def _fold(angle_rad: Array, step_rad: float, span_rad: float, low: float, saturates: bool) -> Fold | None:
    """The fold of one angle; None where the log never leaves its range."""
    fold = Fold(low * span_rad, span_rad, saturates)
    leaves = np.any((angle_rad < fold.low_rad) | (angle_rad > fold.low_rad + span_rad - step_rad / 2.0))
    return fold if step_rad and leaves else None
