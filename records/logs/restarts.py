"""Several recordings in one file, one behind the other: where the clock begins again, what follows is another recording.

They are laid on one clock, so that times increase as everybody expects, with a pause between them that no rows bridge.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_ROWS = 50  # between two falls of a clock: fewer are rows out of order, as no recording is so short
PAUSE_S = 1.0  # between two recordings on one clock, and PAUSE_PERIODS at least: more than a log's missing rows bridge
PAUSE_PERIODS = 10.0
COUNTERS = (2**8, 2**16, 2**32)  # a sequence number begins again there without another recording


@dataclass(frozen=True)
class Restart:
    """Another recording, which begins at `at_s` on the log's clock and at `own_s` on its own."""

    at_s: float
    own_s: float


def restart_rows(values: Array) -> NDArray[np.int64]:
    """Rows at which a clock or a counter (n,) falls back by LEAST_ROWS usual steps, and stays there, for recordings of as many; else
    none."""
    falls = np.flatnonzero(np.diff(values) < 0.0) + 1
    if not falls.size or np.diff([0, *falls.tolist(), len(values)]).min() < LEAST_ROWS:
        return np.zeros(0, np.int64)
    least_fall = LEAST_ROWS * float(np.median(np.diff(values)))
    behind = values[falls[:, None] + np.arange(LEAST_ROWS)]
    stays = (values[falls - 1] - values[falls] >= least_fall) & (np.median(behind, axis=1) < values[falls - 1])
    return falls if stays.all() else np.zeros(0, np.int64)


def pause_s(period_s: float) -> float:
    """Between two recordings of rows so far apart."""
    return max(PAUSE_S, PAUSE_PERIODS * period_s)


def on_one_clock(t_s: Array) -> tuple[Array, tuple[Restart, ...]]:
    """The times (n,) counted on where they begin again, and each place; as they are where they never do."""
    rows = restart_rows(t_s)
    counted, found = t_s.copy(), []
    for row, behind in pairwise([*rows.tolist(), len(t_s)]):
        begins_s = float(np.ceil(counted[row - 1] + pause_s(float(np.median(np.diff(t_s[row:behind]))))))
        counted[row:behind] = begins_s + (t_s[row:behind] - t_s[row])
        found.append(Restart(begins_s, float(t_s[row])))
    return counted, tuple(found)


def counted_on(seq: NDArray[np.int64], begins: NDArray[np.int64]) -> NDArray[np.int64]:
    """Sequence numbers (n,) that go on by one in the rows `begins` of other recordings, and behind the end of a counter."""
    steps = np.diff(seq)
    for row in np.flatnonzero(steps < 0).tolist():
        size = next((size for size in COUNTERS if 0 < steps[row] + size < size // 16), 0)
        steps[row] = 1 if row + 1 in begins else steps[row] + size
    steps[begins - 1] = 1
    return np.concatenate([seq[:1], seq[0] + np.cumsum(steps)])
