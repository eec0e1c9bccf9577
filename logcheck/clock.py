"""Logs whose clock is a calendar's: seconds since 1970 leave no digits for a step of time, and no instant near 0."""

from collections.abc import Sequence
from dataclasses import replace

from logcheck import thresholds
from records.log import RunLog
from records.reasons import Note


def from_their_start(logs: Sequence[RunLog], names: Sequence[str]) -> tuple[list[RunLog], tuple[Note, ...]]:
    """The logs, those that start beyond CALENDAR_S with times from their own start, and a note for each of these."""
    found, notes = [], []
    for log, name in zip(logs, names, strict=True):
        start_s = float(log.t_s[0])
        if abs(start_s) > thresholds.CALENDAR_S:
            said = f"{name}: its times start at {start_s:.0f} s; all times given here count from there"
            notes.append(Note("calendar_clock", name, {"start_s": start_s}, said))
            log = replace(log, t_s=log.t_s - start_s)
        found.append(log)
    return found, tuple(notes)
