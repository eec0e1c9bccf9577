"""Columns of a plant, each on the clock on which it was recorded, as one run log."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.log import RunLog
from records.logs.columns import LogColumns

Array = NDArray[np.float64]

SAME_INSTANT_S = 1e-9  # two clocks of one recording that differ by less show one instant


@dataclass(frozen=True, eq=False)
class Channel:
    """One column as recorded: values (n,) in SI units at t_s (n,); `faults` tells by row what stood there in place of a number.

    A channel without times, t_s None, is one constant.
    """

    t_s: Array | None
    values: Array
    faults: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Span:
    """The part of a recording that is asked for, in its own seconds; both ends are in it."""

    from_s: float = -np.inf
    until_s: float = np.inf

    def holds(self, t_s: Array) -> NDArray[np.bool_]:
        """Which times (n,) are in it; one that is no number counts as the last before it, so that it is not lost silently."""
        if self == Span():
            return np.ones(t_s.shape, dtype=bool)
        times = _last_known(t_s)
        return np.asarray((times >= self.from_s - SAME_INSTANT_S) & (times <= self.until_s + SAME_INSTANT_S))


def log_of_channels(
    channels: Mapping[str, Channel],
    columns: LogColumns,
    where: str,
    *,
    span: Span | None = None,
    loop: str | None = None,
) -> RunLog:
    """The run log of a plant with `columns` from the channels of these names, within `span` as if the rest had not been recorded.

    A row stands wherever an output was measured; an output without a sample then is NaN, inputs and all else hold their last
    value. `loop` None: closed where a reference was recorded. Raises BadInput for a fault, an input without a number, times that do
    not increase, and a recording without two samples, all within the span.
    """
    part = span or Span()
    outputs = {name: _cut(channels[name], part) for name in columns.outputs}
    clocked = {name: _in_order(channel, name, where) for name, channel in outputs.items() if channel.t_s is not None}
    t_s = _instants([t for t, _ in clocked.values()], where, part, channels)
    extra = [name for name in columns.optional if name in channels]
    return RunLog(
        columns=columns,
        sample_period_s=float(f"{min(float(np.median(np.diff(t))) for t, _ in clocked.values() if t.size > 1):.9g}"),
        loop=loop or ("closed" if any("_ref" in name for name in extra) else "open"),
        t_s=t_s,
        u=np.column_stack([_input(channels[name], t_s, name, where) for name in columns.inputs])
        if columns.inputs
        else np.zeros((t_s.size, 0)),
        y=np.column_stack([_sampled(outputs[name], t_s) for name in columns.outputs]),
        extra={name: _held(channels[name], t_s) for name in extra},
    )


def _last_known(t_s: Array) -> Array:
    """The times with the last finite one in place of what is none."""
    rows = np.maximum.accumulate(np.where(np.isfinite(t_s), np.arange(t_s.size), 0))
    known: Array = t_s[rows]
    return known


def taken(channel: Channel, chosen: NDArray[np.bool_]) -> Channel:
    """The samples (n,) of a clocked channel that are chosen, their faults with them."""
    assert channel.t_s is not None
    places = {int(row): place for place, row in enumerate(np.flatnonzero(chosen))} if channel.faults else {}
    faults = {places[row]: told for row, told in channel.faults.items() if row in places}
    return Channel(channel.t_s[chosen], channel.values[chosen], faults)


def _cut(channel: Channel, span: Span) -> Channel:
    """The samples within the span."""
    return channel if channel.t_s is None else taken(channel, span.holds(channel.t_s))


def _in_order(channel: Channel, name: str, where: str) -> tuple[Array, Array]:
    """Times and values of an output; raises BadInput for a fault, and for times that do not increase, with the first that does not."""
    assert channel.t_s is not None
    _without_faults(channel.faults, channel.t_s, name, where)
    t_s = channel.t_s
    late = np.flatnonzero(~(np.diff(t_s) > 0.0))
    if late.size or not np.all(np.isfinite(t_s)):
        row = int(late[0]) if late.size else 0
        time = f"{t_s[row + 1] if t_s.size > 1 else t_s[0]:.9g} s".replace("nan s", "no time")
        got = f"{time} in row {row + 2} after {t_s[row]:.9g} s"
        period_s = _mean_step_s(t_s)
        step = (
            f"{period_s:.6g}*row for rows so far apart on average"
            if period_s > 0.0
            else "0.01*row for rows 10 ms apart"
        )
        remedy = f"say --column t_s={step}; of several recordings in one file give each as its own"
        raise BadInput(f"times of {name}", where, got, "times that increase", remedy)
    return t_s, channel.values


def _mean_step_s(t_s: Array) -> float:
    """The step of rows whose stamps are coarser than they are apart: between the first and the last of which it is known that they begin
    one; 0 where there are none, or the times go back."""
    begin = 1 + np.flatnonzero(np.diff(t_s) > 0.0)
    return float((t_s[begin[-1]] - t_s[begin[0]]) / (begin[-1] - begin[0])) if begin.size > 1 else 0.0


def _instants(clocks: list[Array], where: str, span: Span, channels: Mapping[str, Channel]) -> Array:
    """All times at which any output was sampled, ascending, instants that are the same taken once."""
    times = np.sort(np.concatenate(clocks)) if clocks else np.zeros(0)
    t_s: Array = times[np.concatenate([[True], np.diff(times) > SAME_INSTANT_S])] if times.size else times
    if max((clock.size for clock in clocks), default=0) < 2:
        if span != Span():
            whole = [channel.t_s for channel in channels.values() if channel.t_s is not None and channel.t_s.size]
            ends = (
                f", the file has {np.nanmin([t.min() for t in whole]):g} s to {np.nanmax([t.max() for t in whole]):g} s"
                if whole
                else ""
            )
            got = f"{t_s.size} rows"
            raise BadInput("part of a record", "--from, --until", got, f"two or more{ends}", "choose other times")
        raise BadInput(
            "outputs", where, f"{t_s.size} sample{'' if t_s.size == 1 else 's'}", "at least 2", "record for longer"
        )
    return t_s


def _sampled(channel: Channel, t_s: Array) -> Array:
    """The channel's samples on the rows of their instants, NaN on the others."""
    if channel.t_s is None:
        return np.full(t_s.shape, float(channel.values))
    values = np.full(t_s.shape, np.nan)
    values[np.searchsorted(t_s, channel.t_s - SAME_INSTANT_S)] = _numbers(channel.values)
    return values


def _numbers(values: Array) -> Array:
    """Values with NaN in place of what is infinite."""
    return np.where(np.isfinite(values), values, np.nan)


def _held(channel: Channel, t_s: Array) -> Array:
    """The channel's last value at each row, NaN before its first and where there is no number."""
    if channel.t_s is None:
        return np.full(t_s.shape, float(channel.values))
    rows = _last_rows(channel.t_s, t_s)
    return (
        np.where(rows < 0, np.nan, _numbers(channel.values)[rows]) if channel.t_s.size else np.full(t_s.shape, np.nan)
    )


def _last_rows(clock: Array, t_s: Array) -> NDArray[np.intp]:
    """The row of a clock, in whatever order it is, that was the last at each time; -1 before the first."""
    timed = np.flatnonzero(np.isfinite(clock))
    order = timed[np.argsort(clock[timed], kind="stable")]
    places = np.searchsorted(clock[order], t_s + SAME_INSTANT_S, side="right") - 1
    return np.where(places < 0, -1, order[places]) if order.size else np.full(t_s.shape, -1)


def _input(channel: Channel, t_s: Array, name: str, where: str) -> Array:
    """The channel's last value at each row; raises BadInput when it begins after the first row, and where it is no number."""
    values = _held(channel, t_s)
    if channel.t_s is not None:
        rows = _last_rows(channel.t_s, t_s)
        if rows[0] < 0:
            first_s = float(np.nanmin(channel.t_s, initial=np.inf))
            remedy = f"cut the recording's beginning: --from {first_s:.12g}"
            got = f"its first sample at {first_s:.9g} s"
            raise BadInput(f"column {name!r}", where, got, f"one by {t_s[0]:.9g} s", remedy)
        used = set(rows.tolist()) if channel.faults else set()
        _without_faults({row: told for row, told in channel.faults.items() if row in used}, channel.t_s, name, where)
    return _finite(values, t_s, name, where)


def _without_faults(faults: Mapping[int, str], t_s: Array, name: str, where: str) -> None:
    if faults:
        row = min(faults)
        more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
        place, _, got = faults[row].partition(": ")
        remedy = f"mend it, or cut it off with --until or --from: it is at {_last_known(t_s)[row]:.9g} s"
        raise BadInput(f"column {name!r}", f"{where}, {place}", f"{got}{more}", "a number", remedy)


def _finite(values: Array, t_s: Array, name: str, where: str) -> Array:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        got = f"no number at {t_s[bad[0]]:.9g} s, in {bad.size} of {values.size} rows"
        remedy = "cut the recording with --from or --until to where inputs are known"
        raise BadInput(f"column {name!r}", where, got, "a finite number", remedy)
    return values
