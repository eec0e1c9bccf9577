"""The times of a column's samples: the clock of its signals, or an expression of it."""

import shlex
from functools import partial

import numpy as np
from numpy.typing import NDArray

from recordings.mapping.automatic import ambiguous
from recordings.mapping.evaluation import Number, Quantity, Reference
from recordings.mapping.names import Ambiguous, find
from recordings.mapping.source import Source
from recordings.mapping.values import evaluated, factor_of, parsed, picked, single, unit_for
from recordings.mapping.wraps import clock_past_its_end
from recordings.signals import Signal, Unmapped, listed
from recordings.units import factor_to, known, suffix_of, unit_of_suffix
from records.errors import BadInput

Array = NDArray[np.float64]

TIME = "t_s"
ROW = "row"  # in an expression of times, of a file that has none: 0, 1, 2, ...
CALENDAR = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}
CALENDAR_S = (1e9, 4e9)  # 2001 to 2096 since 1970: no run lasts as long
DAYS = {
    "of MATLAB": (7.3e5, 7.7e5),
    "of a spreadsheet": (3.6e4, 7.4e4),
}  # days since the year 0 and since 1900, of 1999 to 2108
MOST_DAYS = 1e-4  # between rows, 9 s: numbers of that size that go on faster are no days


def times(clock: str | None, length: int, name: str, of: Source) -> tuple[Array, str]:
    """The times [s] of a column's samples: its own clock, or the expression of times with its own clock in place of the file's.

    And what is to be said of them. Raises BadInput where none are known, or none as many as the column has samples.
    """
    text = of.time or clock
    if text is None:
        raise _no_times(of, name, length)
    node = Reference(text) if of.time is None else parsed(TIME, text, of)
    if isinstance(node, Number):
        remedy = f"--column {TIME}=0.01*row for 10 ms between rows"
        raise BadInput(f"column {TIME!r}", f"mapping {text!r}", "a constant", "the times of the samples", remedy)
    ranges: list[float] = []
    quantity = evaluated(TIME, text, node, partial(_look_up, clock=clock, length=length, of=of, ranges=ranges), of)
    factor, told = _calendar(quantity) or factor_of(TIME, text, quantity, of)
    told += "".join(f", whose ticks ran over in {np.log2(size):.0f} bits: counted on" for size in ranges[:1])
    t_s: Array = quantity.values * factor
    if t_s.size != length:
        got = f"{length} values at {t_s.size} times"
        remedy = f"save one run, whole vectors, or name its own times with --column {TIME}=NAME"
        raise BadInput(f"column {name!r}", of.where, got, "one value at each time", remedy)
    return t_s, f"{TIME} = {text}{told}"


def _look_up(reference: Reference, *, clock: str | None, length: int, of: Source, ranges: list[float]) -> Quantity:
    """What a name in an expression of times means: a clock of the file stands for the column's own; ROW for its rows.

    Ticks that ran over are counted on; `ranges` takes their integer's.
    """
    if reference.text == ROW and find(ROW, of.signals) is None:
        return Quantity(np.arange(length, dtype=float))
    number = single(reference, of)
    if number is not None:
        return number
    try:
        meant = find(reference.text, of.signals, of.group)
    except Ambiguous as error:
        if clock is None or not set(error.candidates) <= of.clocks:
            raise ambiguous({TIME: error}, of) from error
        meant = clock
    if clock is not None and (meant in of.clocks or (meant is None and reference.text in (TIME, "time"))):
        used, values = clock, of.signals[clock].values
    else:
        used, values = picked(reference, TIME, of)
    values, size = clock_past_its_end(values)
    ranges += [size] if size else []
    return Quantity(values, unit_for(used, of.signals[used], "s"))


def _calendar(quantity: Quantity) -> tuple[float, str] | None:
    """The factor of times that are dates in ms, us or ns since 1970, or in days where no unit is known, and what is to be said of it; else
    None. A `t_s` that is such a number is called seconds by its name only."""
    if quantity.unit not in ("", "s") or not np.isfinite(quantity.values).any():
        return None
    first = float(np.nanmin(quantity.values))
    if quantity.unit == "" and quantity.values.size > 1 and np.nanmedian(np.diff(quantity.values)) < MOST_DAYS:
        days = next((what for what, (least, most) in DAYS.items() if least <= first < most), None)
        if days:
            return factor_to("s", "days", None), f", dates in days {days}"
    return next(
        ((f, f", dates in {unit}") for unit, f in CALENDAR.items() if CALENDAR_S[0] <= first * f < CALENDAR_S[1]), None
    )


def _no_times(of: Source, name: str, length: int) -> BadInput:
    """What is said where no times of a column are known: none in the file, or none as many as its values."""
    if of.clocks:
        sizes = " or ".join(f"{clock} has {of.signals[clock].values.size}" for clock in sorted(of.clocks)[:4])
        remedy = f"save one run, whole vectors, or name its own times with --column {TIME}=NAME"
        return BadInput(
            f"column {name!r}", of.where, f"{length} values where {sizes}", "one value at each time", remedy
        )
    texts = [f"{unread} ({told})" for unread, told in of.contents.unread.items()]
    rising = (signal for signal in of.signals if _may_be_times(signal, of.signals[signal], length))
    first = next(rising, "NAME")
    remedy = f"name them with --column {shlex.quote(f'{TIME}={first}')}, or --column {TIME}=0.01*row for rows that are 10 ms apart"
    got = listed([*of.signals, *texts, *(f"{single} (one number)" for single in of.contents.singles)])
    return Unmapped(f"column {TIME!r}", of.where, got, "the times of the samples", remedy)


def _may_be_times(name: str, signal: Signal, length: int) -> bool:
    """Whether a signal only increases and bears no unit of anything else."""
    suffix = suffix_of(name)
    unit = known(signal.unit) if signal.unit or not suffix else unit_of_suffix(suffix)
    increases = signal.values.shape == (length,) and bool(np.all(np.diff(signal.values) > 0.0))
    return increases and (unit is None or unit.si == "s")
