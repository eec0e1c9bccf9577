"""Run as a program with the path of an MDF4 file: its channels and the comment of its first group, pickled on standard output.

A program of its own, because a damaged file can end the package asammdf, which is partly in C, and all that runs with it.
Exit status 1 with the package's own words on standard output for a file that it refuses.
"""

import pickle
import sys
from importlib import import_module

import numpy as np

from recordings.channels import Channel


def channels_and_comment(path: str) -> tuple[dict[str, Channel], str]:
    """All channels of numbers by name, of several with one name the first; raises whatever asammdf does."""
    recording = import_module("asammdf").MDF(path)
    groups = {name: places[0] for name, places in recording.channels_db.items()}
    signals = {name: recording.get(name, *place) for name, place in groups.items()}
    comment = str(recording.groups[0].channel_group.comment) if recording.groups else ""
    channels = {
        name: Channel(
            np.asarray(signal.timestamps, float), np.asarray(signal.samples, dtype=float), str(signal.unit or "")
        )
        for name, signal in signals.items()
        if np.asarray(signal.samples).dtype.kind in "biuf" and np.asarray(signal.samples).ndim == 1
    }
    return channels, comment


def main() -> int:
    """Read, and answer on standard output."""
    try:
        answer = pickle.dumps(channels_and_comment(sys.argv[1]))
    except Exception as error:  # the package has no class of its own for a file that is no MDF
        print(error)
        return 1
    sys.stdout.buffer.write(answer)
    return 0


if __name__ == "__main__":
    sys.exit(main())
