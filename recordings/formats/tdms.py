"""Measurement files of LabVIEW and DIAdem (.tdms), by way of the optional package npTDMS."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from recordings.formats.clocks import with_clocks
from recordings.formats.optional import package
from recordings.layout import TextLayout
from recordings.signals import Array, Contents, Signal
from records.errors import BadInput

# Properties of a channel and of a waveform: NI, "TDMS File Format Internal Structure".
UNIT, STEP, OFFSET, BEGIN = "unit_string", "wf_increment", "wf_start_offset", "wf_start_time"


def read(path: Path, asked: TextLayout) -> Contents:
    """Every channel of numbers as `GROUP.CHANNEL`, scaled as the file says; a waveform has its own clock, others one of their group.

    Raises BadInput when npTDMS is not installed, and for a file that is missing or no TDMS.
    """
    nptdms = package("nptdms", "tdms", path)
    if not path.is_file():
        raise BadInput("TDMS file", str(path), "no such file", "a readable file", "check the path")
    signals: dict[str, Signal] = {}
    unread: dict[str, str] = {}
    try:
        with _warnings() as warned, nptdms.TdmsFile.open(path) as recording:
            groups = recording.groups()
            channels = [channel for group in groups for channel in group.channels()]
            first = min((begin for channel in channels if (begin := _begin(channel)) is not None), default=None)
            for channel in channels:
                name = f"{channel.group_name}.{channel.name}"
                own = dict(_signals(name, channel, first))
                signals |= own
                unread |= {} if own else {name: "text or complex, no numbers" if len(channel) else "empty"}
    except Exception as error:  # of the package, of NumPy, and of what a damaged file makes of numbers
        got = f"no whole TDMS file ({type(error).__name__}: {error})"[:200]
        raise BadInput("TDMS file", str(path), got, "a .tdms file", "export it again, or as CSV") from error
    if not signals and warned:
        raise BadInput("TDMS file", str(path), warned[0], "a whole .tdms file", "export it again, or as CSV")
    found = tuple(f"the file is damaged or cut short: {told}" for told in dict.fromkeys(warned))
    return Contents(
        with_clocks(signals), found=found, unread=unread, groups={group.name: group.name for group in groups}
    )


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """What the package warns of, which it would print where a verb's answer stands."""
    told: list[str] = []
    collector = logging.Handler()
    collector.emit = lambda record: told.append(record.getMessage())  # type: ignore[method-assign]
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith("nptdms.")]
    kept = [logger.handlers for logger in loggers]
    for logger in loggers:
        logger.handlers = [collector]
    try:
        yield told
    finally:
        for logger, handlers in zip(loggers, kept, strict=True):
            logger.handlers = handlers


def _signals(name: str, channel: Any, first: Any) -> Iterator[tuple[str, Signal]]:
    """A channel as a signal, and the clock that its step makes, from the first waveform's begin; nothing where it holds no numbers."""
    values = np.asarray(channel[:]) if len(channel) else np.zeros(0)
    if values.dtype.kind == "M":
        since: Array = ((values - values[0]) / np.timedelta64(1, "ns") * 1e-9).astype(float)
        yield name, Signal(since, "s", instants=True)
    elif values.dtype.kind in "biuf" and values.size:
        step = channel.properties.get(STEP)
        clock = f"{name}.t_s" if step else None
        yield name, Signal(values.astype(float), str(channel.properties.get(UNIT) or ""), clock)
        if clock:
            begin = _begin(channel)
            late_s = 0.0 if begin is None else (begin - first) / np.timedelta64(1, "ns") * 1e-9
            t_s = late_s + float(channel.properties.get(OFFSET) or 0.0) + float(step) * np.arange(values.size)
            yield clock, Signal(np.asarray(t_s, dtype=np.float64), "s")


def _begin(channel: Any) -> Any:
    """The date at which a waveform begins, None where the file states none."""
    begin = channel.properties.get(BEGIN)
    return begin if isinstance(begin, np.datetime64) and channel.properties.get(STEP) else None
