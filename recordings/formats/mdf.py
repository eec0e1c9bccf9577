"""ASAM MDF recordings (.mf4, .mdf) of measurement and calibration tools, by way of the optional package asammdf."""

import pickle
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from recordings.formats.mdf_reading import Group
from recordings.formats.optional import missing
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal
from records.errors import BadInput


def read(path: Path, asked: TextLayout) -> Contents:
    """All channels of numbers; one whose name several groups have is `groupN.NAME`, N its group's number; groups without samples are none.

    Raises BadInput when asammdf is not installed, and for a file that is missing or no MDF.
    """
    return contents_of(_groups(path))


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
    return Contents(signals, texts, _told(groups, filled), unread)


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
    return (*told, *((f"{empty} groups without samples are passed over",) if empty else ()))


def _groups(path: Path) -> list[Group]:
    if not path.is_file():
        raise BadInput("MDF file", str(path), "no such file", "a readable file", "check the path")
    if find_spec("asammdf") is None:
        raise missing("asammdf", "mdf4", path)
    command = [sys.executable, "-P", "-m", "recordings.formats.mdf_reading", str(path)]
    done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode == 0:
        groups: list[Group] = pickle.loads(done.stdout)
        return groups
    told = done.stdout.decode(errors="replace").strip() or f"its reader ended with status {done.returncode}"
    raise BadInput("MDF file", str(path), f"no MDF ({told[:200]})", "an MDF file", "export it again")
