"""PX4's logs (.ulg), by way of the optional package pyulog."""

import io
import struct
from collections import Counter
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from recordings.formats.optional import package
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal, counted
from records.errors import BadInput

_US = 1e-6
_HEADER, _BEGINS = (
    struct.Struct("<HB"),
    16,
)  # of a message: how many bytes follow, and its kind; where the first one begins


def read(path: Path, asked: TextLayout) -> Contents:
    """Every field of every topic as `topic.field` at the topic's time stamps, in seconds since the start of the flight controller.

    Of a topic with several instances they are `topic[0].field`, `topic[1].field`. Raises BadInput when pyulog is not installed, and for
    a file that is missing or no ULog.
    """
    pyulog = package("pyulog", "px4", path)
    try:
        with path.open("rb") as stream, redirect_stdout(io.StringIO()):  # it warns there, where the answer goes
            log = pyulog.ULog(stream)  # which leaves open what it opens itself and cannot read
    except FileNotFoundError as error:
        raise BadInput("PX4 log", str(path), "no such file", "a readable file", "check the path") from error
    except Exception as error:  # the package has no class of its own for a file that is no ULog
        raise BadInput("PX4 log", str(path), f"no ULog ({error})", "a .ulg file", "download it again") from error
    counts = Counter(topic.name for topic in log.data_list)
    signals: dict[str, Signal] = {}
    for topic in log.data_list:
        name = topic.name if counts[topic.name] == 1 else f"{topic.name}[{topic.multi_id}]"
        if "timestamp" not in topic.data or not len(topic.data["timestamp"]):
            continue
        clock = f"{name}.timestamp"
        for field, values in topic.data.items():
            if field != "timestamp" and np.asarray(values).dtype.kind in "biuf":
                signals[f"{name}.{field}"] = Signal(np.asarray(values, dtype=float), clock=clock)
        signals[clock] = Signal(np.asarray(topic.data["timestamp"], dtype=float) * _US, "s")
    return Contents(signals, found=_told(log, _ends_within(path)))


def _ends_within(path: Path) -> bool:
    """Whether the file ends within a message, as where the power went or a download stopped: the package passes over that."""
    with path.open("rb") as stream:
        whole, at = stream.seek(0, io.SEEK_END), _BEGINS
        while at + _HEADER.size <= whole:
            stream.seek(at)
            size, _ = _HEADER.unpack(stream.read(_HEADER.size))
            at += _HEADER.size + size
    return at != whole


def _told(log: Any, is_cut: bool) -> tuple[str, ...]:
    dropouts = list(log.dropouts)
    lost_s = sum(dropout.duration for dropout in dropouts) * 1e-3
    damaged = ["the file is damaged: what could not be read is passed over"] if log.file_corruption else []
    if is_cut and not damaged:
        damaged = ["the file ends early, within a message: what came before is read"]
    lost = [f"the logger lost {lost_s:g} s in {counted(len(dropouts), 'drop-outs')}"] if dropouts else []
    return (*damaged, *lost)
