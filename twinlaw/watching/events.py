"""Events for the page: JSON texts in their order, the last minute of them kept for a page that comes later."""

import json
import math
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from diagnosis.validate.ahead import Ahead
from records.logs.live import LiveRow

KEPT = 1200  # events with rows, at 20 a second
DRAWN_EVERY_S = 0.01  # of a log's time; what comes between is not drawn


@dataclass(frozen=True)
class Event:
    """One event: its number, its name, its content as JSON text."""

    number: int
    name: str
    text: str


class Events:
    """Written by one thread, read by many. Rows are kept, of a status the last one."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._kept: deque[Event] = deque(maxlen=KEPT)
        self._status: Event | None = None
        self._number = 0

    def put(self, name: str, content: Mapping[str, Any]) -> None:
        """Publish; `reset` drops what was kept."""
        text = json.dumps(plain(content), allow_nan=False, separators=(",", ":"))
        with self._news:
            self._number += 1
            event = Event(self._number, name, text)
            if name == "status":
                self._status = event
            else:
                if name == "reset":
                    self._kept.clear()
                self._kept.append(event)
            self._news.notify_all()

    def after(self, number: int, patience_s: float) -> list[Event]:
        """Events behind `number` in their order; none when nothing came for so long."""
        with self._news:
            self._news.wait_for(lambda: self._number > number, patience_s)
            found = [event for event in self._kept if event.number > number]
            if self._status is not None and self._status.number > number:
                found.append(self._status)
            return sorted(found, key=lambda event: event.number)


def rows_content(rows: Sequence[LiveRow], found: Sequence[Ahead], gap: Sequence[float | None]) -> dict[str, Any]:
    """Rows and predictions by column, thinned to what can be seen."""
    drawn = thinned(rows)
    return {
        "t": [round(row.t_s, 4) for row in drawn],
        "y": _columns([row.y for row in drawn]),
        "u": _columns([row.u for row in drawn]),
        "r": _columns([row.reference for row in drawn]),
        "ahead": {
            "t": [round(entry.t_s, 4) for entry in found],
            "y": _columns([entry.y for entry in found]),
            "p": _columns([entry.predicted for entry in found]),
        },
        "gap": list(gap),
    }


def thinned(rows: Sequence[LiveRow]) -> list[LiveRow]:
    """Rows that are DRAWN_EVERY_S apart at least, the first among them."""
    kept: list[LiveRow] = []
    for row in rows:
        if not kept or row.t_s - kept[-1].t_s > DRAWN_EVERY_S - 1e-6:
            kept.append(row)
    return kept


def plain(value: Any) -> Any:
    """The same with numbers of six digits, and null where JSON knows no number."""
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    return [plain(entry) for entry in value] if isinstance(value, list | tuple) else value


def _columns(rows: Sequence[Sequence[float]]) -> list[list[float]]:
    return [list(column) for column in zip(*rows, strict=True)]
