"""A run log as an ASAM MDF4 file for measurement tools, by way of the optional package asammdf."""

import tempfile
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from records.errors import BadInput
from records.log import RunLog, sidecar_text
from records.text.units import unit_of

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def mdf4_bytes(log: RunLog) -> bytes:
    """The content of the .mf4: one group of all columns at the log's true times, the sidecar as the group's comment.

    The start time is the epoch, as a log does not state when it was flown. Raises BadInput when asammdf is not installed.
    """
    asammdf = _package()
    names = [*log.columns.inputs, *log.columns.outputs, *log.extra]
    signals = [
        asammdf.Signal(np.ascontiguousarray(log.column(name)), log.t_s, name=name, unit=unit_of(name)) for name in names
    ]
    if log.seq is not None:
        signals.append(asammdf.Signal(log.seq, log.t_s, name="seq"))
    recording = asammdf.MDF(version="4.10")
    try:
        recording.start_time = _EPOCH
        recording.append(signals, comment=sidecar_text(log))
        with tempfile.TemporaryDirectory() as work:
            path = Path(work) / "log.mf4"
            recording.save(path)
            return path.read_bytes()
    finally:
        recording.close()


def _package() -> Any:
    try:
        return import_module("asammdf")
    except ImportError as error:
        raise BadInput(
            "MDF4 file",
            "twinlaw export",
            "no package asammdf to write it with",
            "the optional extra mdf4",
            "install it: .venv/bin/pip install -e '.[mdf4]'",
        ) from error
