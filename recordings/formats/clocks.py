"""The clock of each signal of a file that does not state it: the vector beside it, or above it, that is named as times are."""

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from recordings.signals import Signal
from recordings.units import TIME_NAMES, known, unit_of_clock, without_suffix


def with_clocks(signals: Mapping[str, Signal]) -> dict[str, Signal]:
    """The signals with their clocks: in the innermost structure around one, the only vector of times as long as it is.

    Times are what is named so; where nothing is, dates and times of day; else what rises in a stated unit of time.
    """
    named = [name for name, signal in signals.items() if signal.values.ndim == 1 and is_time_name(name)]
    dated = [name for name, signal in signals.items() if signal.instants]
    clocks = named or dated or [name for name, signal in signals.items() if _rises_in_time(signal)]
    return {name: replace(signal, clock=_clock_of(name, signal, signals, clocks)) for name, signal in signals.items()}


def _rises_in_time(signal: Signal) -> bool:
    unit = known(signal.unit) if signal.unit and signal.values.ndim == 1 else None
    return (
        unit is not None and unit.si == "s" and signal.values.size > 1 and bool(np.all(np.diff(signal.values) >= 0.0))
    )


def is_time_name(name: str) -> bool:
    """Whether the last part of a name is one of times: `log.Time`, `time_ms`, `TimeMs`, `t_s`, `millis`."""
    last = re.split(r"[./]", name)[-1].strip("_")
    if unit_of_clock(last.lower()):
        return True
    if last.endswith(("]", ")")):  # one of many
        return False
    return not TIME_NAMES.isdisjoint((last.lower(), without_suffix(last.lower()), without_suffix(last).lower()))


def _clock_of(name: str, signal: Signal, signals: Mapping[str, Signal], clocks: list[str]) -> str | None:
    if name in clocks:
        return None
    scope = name
    while scope:
        scope = _around(scope)
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
