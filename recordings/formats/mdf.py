"""ASAM MDF recordings (.mf4, .mdf) of measurement and calibration tools, by way of the optional package asammdf."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from recordings.formats.optional import package
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal, counted
from records.errors import BadInput

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Channel:
    """A channel of numbers: samples (n,) or (n, k), NaN where the file marks them as invalid, and its unit."""

    name: str
    values: Array
    unit: str


@dataclass(frozen=True, eq=False)
class Group:
    """Channels on one clock: the group's number in the file, name, comment, times (n,) in s, channels, names of those without numbers."""

    number: int
    name: str
    comment: str
    t_s: Array
    channels: tuple[Channel, ...]
    unread: tuple[str, ...]


def read(path: Path, asked: TextLayout) -> Contents:
    """All channels of numbers; one whose name several groups have is `groupN.NAME`, N its group's number; groups without samples are none.

    Raises BadInput when asammdf is not installed, and for a file that is missing or no MDF.
    """
    asammdf = package("asammdf", "mdf4", path)
    if not path.is_file():
        raise BadInput("MDF file", str(path), "no such file", "a readable file", "check the path")
    try:
        recording = asammdf.MDF(path)
        return contents_of([_group(recording, number) for number in range(len(recording.groups))])
    except Exception as error:  # the package has no class of its own for a file that is no MDF
        raise BadInput("MDF file", str(path), f"no MDF ({error})"[:300], "an MDF file", "export it again") from error


def contents_of(groups: Sequence[Group]) -> Contents:
    """The channels of groups as signals."""
    filled = [group for group in groups if group.t_s.size]
    counts = Counter(channel.name for group in filled for channel in group.channels)
    signals: dict[str, Signal] = {}
    unread: dict[str, str] = {}
    for group in filled:
        clock = f"group{group.number}.t_s"
        signals[clock] = Signal(group.t_s, "s")
        for channel in group.channels:
            once = counts[channel.name] == 1
            name = channel.name if once else _free(f"group{group.number}.{channel.name}", signals)
            signals[name] = Signal(channel.values, channel.unit, clock)
        unread |= dict.fromkeys(group.unread, "text or a structure, no numbers")
    texts = {"sidecar": filled[0].comment} if filled else {}
    named = Counter(group.name for group in filled)
    own = {group.name: f"group{group.number}" for group in filled if group.name and named[group.name] == 1}
    return Contents(signals, texts, _told(groups, filled), unread, groups=own)


def _free(name: str, signals: dict[str, Signal]) -> str:
    """A name that no signal has yet, for the same name twice in one group."""
    number = 2
    while name in signals:
        name, number = f"{name.partition('(')[0]}({number})", number + 1
    return name


def _told(groups: Sequence[Group], filled: Sequence[Group]) -> tuple[str, ...]:
    empty = len(groups) - len(filled)
    shown = ", ".join(f"group {g.number}{f' {g.name}' if g.name else ''}: {g.t_s.size} samples" for g in filled[:8])
    told = [shown] if len(filled) > 1 else []
    return (*told, *((f"{counted(empty, 'groups')} without samples passed over",) if empty else ()))


def _group(recording: Any, number: int) -> Group:
    group, master = recording.groups[number], recording.masters_db.get(number)
    source = getattr(group.channel_group, "acq_name", "") or ""
    channels, unread = [], []
    for index, channel in enumerate(group.channels):
        if index == master:
            continue
        signal = recording.get(group=number, index=index, ignore_invalidation_bits=True)
        values = np.asarray(signal.samples)
        if values.dtype.kind not in "biuf":
            unread.append(str(channel.name))
            continue
        values = values.astype(float)
        invalid = getattr(signal, "invalidation_bits", None)
        if invalid is not None:
            values[np.asarray(invalid, dtype=bool)] = np.nan
        channels.append(Channel(str(channel.name), values, str(signal.unit or "")))
    t_s = np.asarray(recording.get_master(number), dtype=float)
    comment = str(getattr(group.channel_group, "comment", "") or "")
    return Group(number, str(source), comment, t_s, tuple(channels), tuple(unread))
