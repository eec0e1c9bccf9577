"""A plant's prediction one second ahead, sample by sample beside a rig: what its equations expected of now, a second ago.

At each answered instant t the plant's own filter has estimated the state from the readings up to t - 1 s; from there the equations run
freely with the inputs that were commanded since. The running gap is the rms of reading minus prediction over the last seconds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.hypothesis.case import make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.validate.prediction import WINDOW_S, FreeRun, predictions
from logcheck.breaks import gaps
from logcheck.thresholds import BRIDGED_ROWS
from records.log import RunLog
from records.logs.live import LiveRow
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from sim.columns import log_columns

Array = NDArray[np.float64]
EVERY_S = 0.05  # between two predictions
AHEAD_MEMORY_S = decisions.SETTLE_S + WINDOW_S + 2.0  # readings that one prediction is made from
GAP_S = 10.0
# Log10 of the noise on each axis' speed per square root of a second. Less of it leaves less of an exact twin's gap, and lets a twin that
# lacks something lose its state: from -1.5 to -2 the first falls by a third to a half, the second grows by a tenth.
LIVE_PROCESS_NOISE = -2.0


@dataclass(frozen=True)
class Ahead:
    """Reading `y` (outputs) at `t_s` and what was `predicted` of it a second before; NaN where nothing was read."""

    t_s: float
    y: tuple[float, ...]
    predicted: tuple[float, ...]


class Lookahead:
    """The prediction beside a rig whose rows come one after the other; it remembers the last seconds, and nothing else.

    `locked` are the axes that are held. Building it compiles the plant's filter once, which takes seconds the first time.
    """

    def __init__(self, bound: BoundPlant, locked: Sequence[str] = ()) -> None:
        self._library = effect_library(without_effects(bound))
        self._bound = bound
        self._locked = tuple(locked)
        self._rows: list[LiveRow] = []
        self._found: list[Ahead] = []
        self._asked_s = -np.inf

    def forget(self) -> None:
        """Begin anew: the next row is none that follows the last."""
        self._rows, self._found, self._asked_s = [], [], -np.inf

    def take(self, rows: Sequence[LiveRow]) -> tuple[Ahead, ...]:
        """Take the next rows; returns the predictions that are due with them, none in the first three seconds of a log."""
        first = next((place for place, row in enumerate(rows) if row.begins), None)
        if first is None:
            return self._taken(rows)
        before = self._taken(rows[:first])
        self._rows, self._asked_s = [], -np.inf
        return (*before, *self.take([replace(rows[first], begins=False), *rows[first + 1 :]]))

    def _taken(self, rows: Sequence[LiveRow]) -> tuple[Ahead, ...]:
        if not rows:
            return ()
        self._rows.extend(rows)
        due = self._due(len(self._rows) - len(rows))
        found = self._predicted(due) if due else ()
        newest_s = rows[-1].t_s
        self._rows = [row for row in self._rows if row.t_s > newest_s - AHEAD_MEMORY_S]
        self._found = [entry for entry in (*self._found, *found) if entry.t_s > newest_s - GAP_S]
        return found

    @property
    def gap(self) -> tuple[float | None, ...]:
        """Rms of reading minus prediction by output over the last GAP_S, in the outputs' units; None where nothing is known."""
        outputs = len(self._bound.model.outputs)
        error = np.array([np.subtract(entry.y, entry.predicted) for entry in self._found]).reshape(-1, outputs)
        columns = [column[np.isfinite(column)] for column in error.T]
        return tuple(float(np.sqrt(np.mean(column**2))) if column.size else None for column in columns)

    def _due(self, first: int) -> list[FreeRun]:
        """Free runs to the rows from `first` on that are EVERY_S after the last one."""
        t_s = np.array([row.t_s for row in self._rows])
        spans = []
        for row in range(first, len(t_s)):
            begin = int(np.searchsorted(t_s, t_s[row] - WINDOW_S + 1e-9, side="right")) - 1
            if t_s[row] >= self._asked_s + EVERY_S - 1e-9 and begin >= 0 and t_s[begin] - t_s[0] >= decisions.SETTLE_S:
                spans.append(FreeRun(begin, row, row + 1))
                self._asked_s = float(t_s[row])
        return spans

    def _predicted(self, spans: Sequence[FreeRun]) -> tuple[Ahead, ...]:
        rows = self._rows
        log = RunLog(
            columns=log_columns(self._bound.model),
            sample_period_s=EVERY_S,
            loop="closed",
            t_s=np.array([row.t_s for row in rows]),
            u=np.array([row.u for row in rows]),
            y=np.array([row.y for row in rows]),
            locked=self._locked,
        )
        case = make_case(self._library, [log], stated=self._bound)
        hypothesis = nominal_hypothesis(case, LIVE_PROCESS_NOISE)
        found = predictions(case, case.flights[0], hypothesis, spans=spans)
        starts, firsts = ([getattr(span, name) for span in spans] for name in ("start", "first"))
        told = np.where(_settled(log)[starts], found[firsts], np.nan)
        return tuple(
            Ahead(rows[first].t_s, rows[first].y, tuple(predicted))
            for first, predicted in zip(firsts, told.tolist(), strict=True)
        )


def _settled(log: RunLog) -> NDArray[np.bool_]:
    """Rows and outputs (n, outputs) in which the filter does not go by what it reckoned along a stretch without readings of the output:
    from SETTLE_S behind such a stretch on."""
    settled = np.ones(log.y.shape, bool)
    for column, y in zip(settled.T, log.y.T, strict=True):
        read = np.flatnonzero(np.isfinite(y))
        first = read[:1][read[:1] > BRIDGED_ROWS]
        for again in (*first, *read[gaps(log.t_s[read])]):
            last = int(np.searchsorted(read, again)) - 1
            stops = int(read[last]) + 1 if last >= 0 else 0
            column[stops : np.searchsorted(log.t_s, log.t_s[again] + decisions.SETTLE_S - 1e-9)] = False
    return settled
