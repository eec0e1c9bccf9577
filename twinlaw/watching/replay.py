"""A log as what is watched: its rows come again at its own pace, faster or slower, from any instant."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis.validate.ahead import AHEAD_MEMORY_S
from records.errors import BadInput
from records.log import RunLog
from records.logs.live import LiveRow
from sim.columns import reference_name
from twinlaw.watching.source import Step

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0)
STEP_S = 0.05  # on the wall clock


class LogSource:
    """One log. Time is that of the log since its first row; it stands when all rows have come."""

    armed = False

    def __init__(self, log: RunLog, facts: Mapping[str, Any], begins: NDArray[np.bool_] | None = None) -> None:
        """With the rows `begins` (n,) another log begins."""
        self.anew = False
        self._facts = facts
        self._rows = live_rows(log, begins)
        self._referenced = [output for output in log.columns.outputs if reference_name(output) in log.extra]
        self._end_s = self._rows[-1].t_s
        self._now_s, self._next = 0.0, 0
        self._playing, self._speed = True, 1.0

    def facts(self) -> Mapping[str, Any]:
        """Kind and length."""
        own = {"kind": "log", "duration_s": self._end_s, "speeds": SPEEDS, "referenced": self._referenced}
        return {**self._facts, **own}

    def status(self) -> Mapping[str, Any]:
        """Where the replay is."""
        return {"playing": self._playing, "speed": self._speed, "t_s": self._now_s, "armed": False, "trouble": None}

    def obey(self, wish: Mapping[str, Any]) -> None:
        """Pause, play, another speed, another instant."""
        if wish["do"] == "pause":
            self._playing = False
        elif wish["do"] == "play":
            if self._next == len(self._rows):
                self._seek(0.0)
            self._playing = True
        elif wish["do"] == "speed":
            if wish.get("factor") not in SPEEDS:
                known = ", ".join(f"{speed:g}" for speed in SPEEDS)
                raise _refused(f"a speed of {wish.get('factor')!r:.20}", f"one of {known}")
            self._speed = float(wish["factor"])
        elif wish["do"] == "seek":
            self._seek(wish.get("t_s"))
        else:
            raise _refused(f"{wish['do']!r:.20}", "pause, play, speed or seek: a log cannot be armed")

    def step(self) -> Step:
        """The rows of the next stretch."""
        if not self._playing:
            return Step((), STEP_S)
        self._now_s = min(self._now_s + STEP_S * self._speed, self._end_s)
        first = self._next
        while self._next < len(self._rows) and self._rows[self._next].t_s <= self._now_s + 1e-9:
            self._next += 1
        self._playing = self._next < len(self._rows)
        return Step(self._rows[first : self._next], STEP_S)

    def disarm(self) -> None:
        """A log is never armed."""

    def close(self) -> None:
        """Nothing is open."""

    def _seek(self, t_s: Any) -> None:
        """Go on so far before `t_s` that the prediction is there with it."""
        if not isinstance(t_s, int | float) or not math.isfinite(t_s) or not 0.0 <= t_s <= self._end_s:
            raise _refused(f"an instant of {t_s!r:.20} s", f"0 to {self._end_s:g} s")
        self.anew = True
        self._now_s = float(t_s)
        self._next = next(
            k for k, row in enumerate(self._rows) if row.t_s >= min(max(0.0, t_s - AHEAD_MEMORY_S), self._end_s)
        )
        self._playing = True


def live_rows(log: RunLog, begins: NDArray[np.bool_] | None = None) -> list[LiveRow]:
    """The log's rows, its time counted from the first; with the rows `begins` (n,) another log begins."""
    names = [reference_name(output) for output in log.columns.outputs]
    missing = [math.nan] * len(log.t_s)
    columns = [log.extra[name].tolist() if name in log.extra else missing for name in names]
    times = (log.t_s - log.t_s[0]).tolist()
    marked = [False] * len(times) if begins is None else begins.tolist()
    rows = zip(times, log.u.tolist(), log.y.tolist(), zip(*columns, strict=True), marked, strict=True)
    return [LiveRow(t_s, tuple(u), tuple(y), tuple(reference), begin) for t_s, u, y, reference, begin in rows]


def _refused(got: str, expected: str) -> BadInput:
    return BadInput("wish", "log", got, expected, "use the page's own buttons")
