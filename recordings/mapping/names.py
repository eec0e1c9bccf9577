"""Which signal of a file a name means: its whole name, its heading, or an ending that only one has."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from recordings.signals import Signal

PATH = "./:"  # between a name and what it lies in: a structure, a topic, PLECS' scope


@dataclass(frozen=True)
class Ambiguous(Exception):
    """A name that several signals bear."""

    candidates: tuple[str, ...]


def find(name: str, signals: Mapping[str, Signal], group: str | None = None) -> str | None:
    """The signal that `name` means, None where there is none; of several those under `group`.

    Raises Ambiguous where more than one is left: never the first or the last silently.
    """
    if name in signals:
        return name
    candidates = _candidates(name, signals)
    if len(candidates) > 1 and group is not None:
        candidates = [candidate for candidate in candidates if is_under(candidate, group)]
    if len(candidates) > 1:
        raise Ambiguous(tuple(candidates))
    return candidates[0] if candidates else None


def is_under(name: str, group: str) -> bool:
    """Whether a signal lies in a group: a structure, a topic, a group of channels by its number or name."""
    return any(
        name.startswith(f"{start}{mark}") for start in (group, f"group{group}", f"/{group}") for mark in f"{PATH}[("
    )


def _candidates(name: str, signals: Mapping[str, Signal]) -> list[str]:
    headed = [known for known, signal in signals.items() if signal.heading == name]
    if headed:
        return headed
    plain = name.replace("(1)", "")  # of a structure that is the only one of its kind
    endings = tuple(f"{mark}{plain}" for mark in PATH)
    for bare in (without_device, _without_instances):
        alike = [known for known in signals if bare(known) == plain or bare(known).endswith(endings)]
        if alike:
            return alike
    return []


def without_device(name: str) -> str:
    """The name without what a calibration tool writes behind it: `psi_rad` of `psi_rad\\XCP:1`."""
    return re.sub(r"\\.*$", "", name)


def _without_instances(name: str) -> str:
    """The name without the number of a topic or structure of several: `sensor.x` of `sensor[1].x`."""
    return re.sub(r"[\[(]\d+[\])](?=\.)", "", name)
