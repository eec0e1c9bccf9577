"""ASAM MDF4 recordings (.mf4) of measurement and calibration tools, by way of the optional package asammdf."""

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from recordings.channels import Channel
from records.errors import BadInput


def read_mdf4(path: Path) -> tuple[dict[str, Channel], str]:
    """All channels of numbers by name, of several with one name the first; and the comment of the first group.

    Raises BadInput when asammdf is not installed, and for a file that is missing or no MDF.
    """
    if not path.is_file():
        raise BadInput("MDF4 file", str(path), "no such file", "a readable file", "check the path")
    recording = _open(path)
    try:
        groups = {name: places[0] for name, places in recording.channels_db.items()}
        signals = {name: recording.get(name, *place) for name, place in groups.items()}
        comment = str(recording.groups[0].channel_group.comment) if recording.groups else ""
    finally:
        recording.close()
    channels = {
        name: Channel(
            np.asarray(signal.timestamps, float), np.asarray(signal.samples, dtype=float), str(signal.unit or "")
        )
        for name, signal in signals.items()
        if np.asarray(signal.samples).dtype.kind in "biuf" and np.asarray(signal.samples).ndim == 1
    }
    return channels, comment


def _open(path: Path) -> Any:
    try:
        asammdf = import_module("asammdf")
    except ImportError as error:
        raise BadInput(
            "MDF4 file",
            str(path),
            "no package asammdf to read it with",
            "the optional extra mdf4",
            "install it: .venv/bin/pip install -e '.[mdf4]'",
        ) from error
    try:
        return asammdf.MDF(path)
    except Exception as error:  # whatever the package makes of a file that is none: it has no class of its own for that
        raise BadInput("MDF4 file", str(path), f"no MDF ({error})", "an MDF4 file", "export it again") from error
