"""The clock of each signal of a file that does not state it: the vector beside it, or above it, that is named as times are."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from recordings.signals import Signal
from recordings.units import (
    DATE_NAMES,
    TIME_NAMES,
    Unit,
    known,
    suffix_of,
    unit_of_clock,
    unit_of_suffix,
    without_suffix,
)


def with_clocks(signals: Mapping[str, Signal]) -> dict[str, Signal]:
    """The signals with their clocks: in the innermost structure around one, the only vector of times as long as it is.

    Times are what is named so; where nothing is, dates and times of day; else what rises in a stated unit of time; else what is named as
    dates are, which a spreadsheet writes as numbers.
    """
    named = _without_temperatures(
        [
            name
            for name, signal in signals.items()
            if signal.values.ndim == 1
            and (is_time_name(name) or is_time_name(signal.heading))
            and not _of_another_quantity(known(signal.unit))
        ]
    )
    dated = [name for name, signal in signals.items() if signal.instants]
    rising = [name for name, signal in signals.items() if _rises_in_time(signal)]
    clocks = named or dated or rising or [name for name in signals if name.lower() in DATE_NAMES]
    return {
        name: replace(signal, clock=signal.clock or _clock_of(name, signal, signals, clocks))
        for name, signal in signals.items()
    }


def with_clocks_in_front(signals: Mapping[str, Signal]) -> dict[str, Signal]:
    """The columns of a table with the clocks in front of them, where a column of times stands in front of each or of each few.

    Such columns have one heading, as `X_Value` again and again or, but for numbers, `time1`, `time2`, and each rises. Rows below the last
    of a clock's times are no samples. As they are where the table has one clock for all.
    """
    clocks = _in_front(signals)
    if not clocks:
        return dict(signals)
    found: dict[str, Signal] = {}
    clock = clocks[0]
    for name, signal in signals.items():
        clock = name if name in clocks else clock
        whole = _ended(signal, signals[clock])
        found[name] = whole if name == clock else replace(whole, clock=clock)
    return found


def _in_front(signals: Mapping[str, Signal]) -> list[str]:
    """The rising columns of the first one's heading, or of its name of times with other numbers, another signal behind each of them."""
    headings = [
        re.sub(r"^c\d+\.", "", name) for name in signals
    ]  # a heading that stands again has its column before it
    first = headings[0] if headings else ""
    stem = _without_numbers(first)
    same = _without_numbers if is_time_name(stem) else str
    alike = [name for name, heading in zip(signals, headings, strict=True) if same(heading) == same(first)]
    behind = dict(pairwise([*signals, ""]))
    rise = all(bool(np.all(np.diff(_ended(signals[name], signals[name]).values) > 0.0)) for name in alike)
    apart = not any(behind[name] in ("", *alike) for name in alike)
    return alike if len(alike) > 1 and rise and apart else []


def _without_numbers(heading: str) -> str:
    return re.sub(r"[ _]?\d+", "", heading)


def _ended(signal: Signal, clock: Signal) -> Signal:
    """The signal without the rows below the last of its clock's times."""
    end = int(np.max(np.flatnonzero(np.isfinite(clock.values)), initial=-1)) + 1
    faults = {row: told for row, told in signal.faults.items() if row < end}
    return replace(signal, values=signal.values[:end], faults=faults)


def _rises_in_time(signal: Signal) -> bool:
    unit = known(signal.unit) if signal.unit and signal.values.ndim == 1 else None
    return (
        unit is not None and unit.si == "s" and signal.values.size > 1 and bool(np.all(np.diff(signal.values) >= 0.0))
    )


def is_time_name(name: str) -> bool:
    """Whether the last part of a name is one of times: `log.Time`, `time_ms`, `TimeMs`, `t_s`, `millis`."""
    last = _last(name).strip("_")
    if unit_of_clock(last.lower()):
        return True
    suffix = suffix_of(last)
    if last.endswith(("]", ")")) or (suffix and _of_another_quantity(unit_of_suffix(suffix))):  # one of many; T_K
        return False
    return not TIME_NAMES.isdisjoint((last.lower(), without_suffix(last.lower()), without_suffix(last).lower()))


def _without_temperatures(named: Sequence[str]) -> list[str]:
    """The names of times without T where another stands beside it: then it is a temperature or a torque."""
    return [name for name in named if _last(name) != "T" or sum(_around(one) == _around(name) for one in named) == 1]


def _last(name: str) -> str:
    return re.split(r"[./:]", name)[-1]


def _of_another_quantity(unit: Unit | None) -> bool:
    """Whether a unit is one of something else than time, of which counts may be."""
    return unit is not None and unit.si not in ("s", "1") and not unit.per_turn


def _clock_of(name: str, signal: Signal, signals: Mapping[str, Signal], clocks: list[str]) -> str | None:
    if name in clocks:
        return None
    scopes = [name]  # what lies under a matrix are its own columns, where they have names
    while scopes[-1]:
        scopes.append(_around(scopes[-1]))
    for scope in scopes:
        beside = [
            clock
            for clock in clocks
            if _within(clock, signals) == scope and signals[clock].values.size in signal.values.shape
        ]
        exact = [clock for clock in beside if clock.endswith("t_s")] or beside
        if exact:
            return exact[0] if len(exact) == 1 else None
    return None


def _around(name: str) -> str:
    """The structure in which a name lies, empty for none."""
    return name[: max(name.rfind("."), name.rfind("/"), 0)]


def _within(clock: str, signals: Mapping[str, Signal]) -> str:
    """The innermost structure around a clock that holds anything else: none for the heading Date/Time."""
    scope = _around(clock)
    while scope and not any(name != clock and name.startswith((f"{scope}.", f"{scope}/")) for name in signals):
        scope = _around(scope)
    return scope
