"""Channels of one file as one recording: several runs behind one another on one clock, and nothing before the inputs are known."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from recordings.channels import Array, Channel, Span, taken
from recordings.signals import counted
from records.logs.coarse_stamps import own_times
from records.logs.columns import LogColumns
from records.logs.restarts import pause_s, restart_rows
from records.logs.unwritten import unwritten_rows

SPARSE = 0.3  # of a column without a number: of two rates the nearest that loggers write into one table are 3 to 2, a third without
EVENLY = 10  # times the usual rows to the next number: beyond it a signal was not logged for a while, and nobody knows what it was


def in_own_rows(channels: Mapping[str, Channel], columns: LogColumns) -> tuple[dict[str, Channel], list[str]]:
    """The inputs and what is beside them without the rows in which another signal alone was written, and what is to be said of it.

    So are the outputs where every input is: else a row without an output still tells when an input changed.
    """
    held = [name for name in channels if name not in columns.outputs and _is_sparse(channels[name])]
    inputs_too = all(name in held for name in columns.inputs if channels[name].t_s is not None)
    outputs = [name for name in columns.outputs if _is_sparse(channels[name])] if held and inputs_too else []
    thinned = {name: _known(channels[name]) for name in (*held, *outputs)}
    told = [
        f"{name} has a number in {_size(thinned[name])} of {_size(channels[name])} rows, and holds it until the next"
        for name in held
    ]
    return {**channels, **thinned}, told


def _is_sparse(channel: Channel) -> bool:
    """Whether a clocked channel has numbers, evenly in so few rows that the others are rows of other signals."""
    numbers = np.flatnonzero(~np.isnan(channel.values)) if channel.t_s is not None else np.zeros(0, np.int64)
    if not numbers.size:
        return False
    steps = np.diff(numbers, append=channel.values.size)
    lacking = 1.0 - numbers.size / (channel.values.size - numbers[0])
    return bool(lacking >= SPARSE and steps.max() <= EVENLY * np.median(steps))


def _known(channel: Channel) -> Channel:
    """The samples of a clocked channel that are numbers or faults."""
    chosen = ~np.isnan(channel.values)
    chosen[list(channel.faults)] = True
    return taken(channel, chosen)


def _size(channel: Channel) -> int:
    return int(channel.values.size)


def without_unwritten_rows(
    channels: Mapping[str, Channel], columns: LogColumns
) -> tuple[dict[str, Channel], list[str]]:
    """The channels of one clock without the rows in which none of them was written, and what is to be said of these."""
    clocked = {name: channel for name, channel in channels.items() if channel.t_s is not None}
    clocks = [channel.t_s for channel in clocked.values() if channel.t_s is not None]
    clock = clocks[0] if clocks else np.zeros(0)
    if not all(np.array_equal(other, clock, equal_nan=True) for other in clocks) or not clocks:
        return dict(channels), []
    u, y = (
        np.column_stack([clocked[name].values for name in names if name in clocked] or [np.zeros((clock.size, 0))])
        for names in (columns.inputs, columns.outputs)
    )
    beside = [channel.values for name, channel in clocked.items() if name not in (*columns.inputs, *columns.outputs)]
    lost = unwritten_rows(u, y, beside)
    lost[[row for channel in clocked.values() for row in channel.faults]] = False
    if not lost.any():
        return dict(channels), []
    kept = {name: taken(channel, ~lost) for name, channel in clocked.items()}
    first_s = float(clock[lost][0])
    said = f"{counted(int(lost.sum()), 'rows')} in which nothing was written left out, first at {first_s:.9g} s"
    return {**channels, **kept}, [said]


def to_the_last_time(channels: Mapping[str, Channel]) -> tuple[dict[str, Channel], list[str]]:
    """The channels without the samples behind the last that bears a time, as a line of sums below a table does, and what is said of it."""
    kept, left_out = dict(channels), 0
    for name, channel in channels.items():
        timed = np.flatnonzero(np.isfinite(channel.t_s)) if channel.t_s is not None else np.zeros(0, np.int64)
        behind = _size(channel) - 1 - int(timed[-1]) if timed.size else 0
        if behind:
            kept[name] = taken(channel, np.arange(_size(channel)) <= timed[-1])
            left_out = max(left_out, behind)
    return kept, [f"{counted(left_out, 'rows')} without a time at the end left out"] if left_out else []


def on_one_clock(channels: Mapping[str, Channel]) -> tuple[dict[str, Channel], list[str]]:
    """The channels with times that count on where they begin again, and what is to be said of it.

    As they are where clocks begin again unlike one another: then nobody knows which samples belong together.
    """
    clocks = {name: channel.t_s for name, channel in channels.items() if channel.t_s is not None}
    rows = {
        name: restart_rows(t_s) if np.isfinite(t_s).all() else np.zeros(0, np.int64) for name, t_s in clocks.items()
    }
    counts = {len(found) for found in rows.values()}
    if len(counts) != 1 or counts == {0}:
        return dict(channels), []
    pieces = {name: list(pairwise([0, *rows[name].tolist(), len(t_s)])) for name, t_s in clocks.items()}
    shifts, begins = _counted_on(clocks, pieces)
    moved = {
        name: np.concatenate([t_s[a:b] + shift for (a, b), shift in zip(pieces[name], shifts, strict=True)])
        for name, t_s in clocks.items()
    }
    told = ", ".join(f"{begin:g} s" for begin in begins[1:4])
    said = (
        f"times begin again at {len(begins) - 1} place{'s' if len(begins) > 2 else ''}: several recordings in one file; they count on from "
        f"{told} here, and each is used as another log"
    )
    return {name: Channel(moved.get(name), c.values, c.faults) for name, c in channels.items()}, [said]


def _counted_on(
    clocks: Mapping[str, Array], pieces: Mapping[str, Sequence[tuple[int, int]]]
) -> tuple[list[float], list[float]]:
    """By how much the times of each recording move, and where it begins then: in the first whole second behind a pause."""
    shifts, begins, end_s = [0.0], [], -np.inf
    for number in range(len(next(iter(pieces.values())))):
        runs = [t_s[slice(*pieces[name][number])] for name, t_s in clocks.items()]
        first_s, last_s = min(run[0] for run in runs), max(run[-1] for run in runs)
        if number:
            shifts.append(float(np.ceil(end_s) - first_s))
        begins.append(float(first_s + shifts[-1]))
        end_s = last_s + shifts[-1] + pause_s(max(float(np.median(np.diff(run))) for run in runs))
    return shifts, begins


def with_own_times(
    channels: Mapping[str, Channel], columns: LogColumns, where: str
) -> tuple[dict[str, Channel], list[str]]:
    """The channels with a time for each sample where stamps are too coarse to tell them apart, and what is to be said of it.

    What was logged on the clock of an output moves with it. Raises BadInput where nothing tells how far apart samples are.
    """
    moved, told = dict(channels), dict[str, None]()
    for name in columns.outputs:
        clock = moved[name].t_s
        if clock is None or not np.isfinite(clock).all():
            continue
        beside = [other for other, c in moved.items() if c.t_s is not None and np.array_equal(c.t_s, clock)]
        readings = np.column_stack([moved[other].values for other in beside if other in columns.outputs])
        t_s, spread = own_times(clock, readings, where)
        if spread is not None:
            told[f"{', '.join(beside)}: {spread.told}"] = None
            moved |= {other: Channel(t_s, moved[other].values, moved[other].faults) for other in beside}
    return moved, list(told)


def in_order(channels: Mapping[str, Channel], columns: LogColumns, span: Span) -> tuple[dict[str, Channel], list[str]]:
    """The outputs without samples whose time does not rise within the span, and what is to be said of them.

    As they are where these are half and more, not counting rows written twice: then the clock is no clock. What holds its last value
    may be in any order.
    """
    kept, told = dict(channels), []
    for name in columns.outputs:
        channel = channels[name]
        if channel.t_s is None or not np.isfinite(channel.t_s).all():
            continue
        late = np.concatenate([[False], channel.t_s[1:] <= np.maximum.accumulate(channel.t_s)[:-1]])
        late &= span.holds(channel.t_s)
        again = np.concatenate([[False], (np.diff(channel.t_s) == 0.0) & (np.diff(channel.values) == 0.0)])
        if late.any() and (late & ~again).sum() < 0.5 * late.size:
            kept[name] = taken(channel, ~late)
            first_s = channel.t_s[late][0]
            told.append(
                f"{name}: {counted(late.sum(), 'samples')} whose time does not rise left out, first at {first_s:.9g} s"
            )
    return kept, told


def from_the_inputs(channels: Mapping[str, Channel], columns: LogColumns, span: Span) -> tuple[Span, list[str]]:
    """The span from where every input is known, and what is to be said of the samples in front of it; as it is for a plant without any."""
    if not columns.inputs:
        return span, []
    firsts = {name: _first_s(channels[name], span) for name in columns.inputs}
    name = max(firsts, key=lambda name: firsts[name])
    begin_s = firsts[name]
    outputs = [channels[column].t_s for column in columns.outputs]
    lost = max((int(np.sum(span.holds(t_s) & (t_s < begin_s))) for t_s in outputs if t_s is not None), default=0)
    if not np.isfinite(begin_s) or not lost:
        return span, []
    said = f"{name} begins at {begin_s:.9g} s: {lost} samples of the outputs in front of it are left out"
    return Span(begin_s, span.until_s), [said]


def _first_s(channel: Channel, span: Span) -> float:
    """When a channel has its first number within the span; before all time for a constant and for one that is known before."""
    if channel.t_s is None:
        return -np.inf
    known = np.isfinite(channel.values) & np.isfinite(channel.t_s)
    if np.any(known & (channel.t_s <= span.from_s)):
        return -np.inf
    return float(np.min(channel.t_s[known], initial=np.inf))
