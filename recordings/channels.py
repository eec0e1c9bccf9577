"""Signals as a measurement tool recorded them, each under its own name, unit and clock, as one run log."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.log import LogColumns, RunLog
from records.text.units import dimension, unit_of

Array = NDArray[np.float64]

SAME_INSTANT_S = 1e-9  # two clocks of one recording that differ by less show one instant


@dataclass(frozen=True, eq=False)
class Channel:
    """One recorded signal: values (n,) at t_s (n,), and its unit as the file states it, empty where it states none."""

    t_s: Array
    values: Array
    unit: str = ""


@dataclass(frozen=True)
class Choice:
    """Which channel gives a column, and the factor from the channel's unit to the column's (None: the unit is the column's)."""

    channel: str
    factor: float | None = None


def log_of_channels(
    channels: Mapping[str, Channel],
    columns: LogColumns,
    where: str,
    *,
    choices: Mapping[str, Choice] | None = None,
    loop: str | None = None,
    table_digest: str | None = None,
) -> RunLog:
    """The run log of a plant with `columns`; a column is the channel of its own name unless `choices` names another.

    A row stands wherever an output was measured; an output without a sample then is NaN, inputs and all else hold their last
    value. `loop` None: closed where a reference was recorded. Raises BadInput for a missing channel, a unit that is not the
    column's, a chosen column that the plant does not have, and a recording without two samples.
    """
    chosen = dict(choices or {})
    known = (*columns.inputs, *columns.outputs, *columns.optional)
    for name in chosen:
        if name not in known:
            raise BadInput(f"column {name!r}", where, "an unknown column", f"one of {', '.join(known)}", "rename it")
    found = {name: _column(channels, name, chosen.get(name), where) for name in (*columns.inputs, *columns.outputs)}
    wanted = [name for name in columns.optional if name in chosen or name in channels]
    extra = {name: _column(channels, name, chosen.get(name), where) for name in wanted}
    t_s = _instants([found[name].t_s for name in columns.outputs], where)
    return RunLog(
        columns=columns,
        sample_period_s=float(f"{np.median(np.diff(t_s)):.9g}"),
        loop=loop or ("closed" if any("_ref" in name for name in extra) else "open"),
        t_s=t_s,
        u=np.column_stack([_finite(_held(found[name], t_s, name, where), name, where) for name in columns.inputs]),
        y=np.column_stack([_sampled(found[name], t_s) for name in columns.outputs]),
        extra={name: _held(channel, t_s, name, where) for name, channel in extra.items()},
        table_digest=table_digest,
    )


def _column(channels: Mapping[str, Channel], name: str, choice: Choice | None, where: str) -> Channel:
    choice = choice or Choice(name)
    if choice.channel not in channels:
        there = ", ".join(channels) or "no channel at all"
        raise BadInput(
            f"channel {choice.channel!r}",
            where,
            there if len(there) <= 300 else f"{there[:297]}...",
            f"a channel for the column {name}",
            f"name it with --column {name}=CHANNEL, and its factor to SI units with --column {name}=CHANNEL*FACTOR",
        )
    channel = channels[choice.channel]
    if choice.factor is None:
        _check_unit(channel.unit, name, choice.channel, where)
    return Channel(channel.t_s, channel.values * (1.0 if choice.factor is None else choice.factor))


def _check_unit(unit: str, name: str, channel: str, where: str) -> None:
    """A stated unit must be the one that the column's name bears."""
    expected = unit_of(name) or "1"
    try:
        fits = not unit.strip() or dimension(unit) == dimension(expected)
    except ValueError:
        fits = False
    if not fits:
        remedy = f"give the factor to {expected}: --column {name}={channel}*FACTOR (degrees: 0.017453292519943295)"
        raise BadInput(f"unit of channel {channel!r}", where, repr(unit), expected, remedy)


def _instants(clocks: list[Array], where: str) -> Array:
    """All times at which any output was sampled, ascending, instants that are the same taken once."""
    for clock in clocks:
        if not (np.all(np.isfinite(clock)) and np.all(np.diff(clock) > 0.0)):
            got = "times that stand still, go back or are no numbers"
            raise BadInput("times of an output", where, got, "times that increase", "sort the samples, drop doubles")
    times = np.sort(np.concatenate(clocks))
    t_s: Array = times[np.concatenate([[True], np.diff(times) > SAME_INSTANT_S])] if times.size else times
    if t_s.size < 2:
        raise BadInput("outputs", where, f"{t_s.size} samples", "at least 2", "record for longer")
    return t_s


def _sampled(channel: Channel, t_s: Array) -> Array:
    """The channel's samples on the rows of their instants, NaN on the others."""
    values = np.full(t_s.shape, np.nan)
    values[np.searchsorted(t_s, channel.t_s - SAME_INSTANT_S)] = np.where(
        np.isfinite(channel.values), channel.values, np.nan
    )
    return values


def _held(channel: Channel, t_s: Array, name: str, where: str) -> Array:
    """The channel's last value at each row; raises BadInput when it begins after the first row."""
    order = np.argsort(channel.t_s, kind="stable")
    index = np.searchsorted(channel.t_s[order], t_s + SAME_INSTANT_S, side="right") - 1
    if index[0] < 0:
        begins = f"its first sample at {np.min(channel.t_s, initial=np.inf):g} s"
        raise BadInput(f"column {name!r}", where, begins, f"one by {t_s[0]:g} s", "cut the recording's beginning")
    values: Array = channel.values[order][index]
    return values


def _finite(values: Array, name: str, where: str) -> Array:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        got = f"{values[bad[0]]:g} at sample {bad[0]}"
        raise BadInput(f"column {name!r}", where, got, "a finite number", "cut the recording to where inputs are known")
    return values
