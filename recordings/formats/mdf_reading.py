"""Run as a program with the path of an MDF file: its groups of channels, pickled on standard output.

A program of its own, because a damaged file can end the package asammdf, which is partly in C, and all that runs with it.
Exit status 1 with the package's own words on standard output for a file that it refuses.
"""

import pickle
import sys
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

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


def groups(path: str) -> list[Group]:
    """All groups of a file; raises whatever asammdf does."""
    recording = import_module("asammdf").MDF(path)
    return [_group(recording, number) for number in range(len(recording.groups))]


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


def main() -> int:
    """Read, and answer on standard output."""
    try:
        answer = pickle.dumps(groups(sys.argv[1]))
    except Exception as error:  # the package has no class of its own for a file that is no MDF
        print(error)
        return 1
    sys.stdout.buffer.write(answer)
    return 0


if __name__ == "__main__":
    from recordings.formats.mdf_reading import main as named_main  # so that what is pickled is of the module's own name

    sys.exit(named_main())
