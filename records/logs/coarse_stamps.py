"""Stamps that repeat on real samples: a clock of 1 ms in a log of 2 kHz, stamps printed with too few digits, rows written in bursts.

Where the stamps and the number of rows tell how far apart the rows are, each gets a time of its own. A row that repeats the stamp and the
readings before it is no sample: such rows stay as they are.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput

Array = NDArray[np.float64]

MANY = 0.1  # of a log's rows that repeat a stamp: the stamps are coarser than the rows, and not a few of them wrong
NEWS = 0.5  # of the share of new stamps with another reading: a row written twice has none, a sample as many
LOST_ROWS = 3.0  # within one stamp: so far the times of its rows may be wrong, which is what a filter bridges
GAP_STAMPS = 4.5  # usual steps from stamp to stamp: behind a longer one rows count anew
LEAST_STAMPS = 4  # the first and the last may stand for fewer rows


@dataclass(frozen=True)
class Spread:
    """Rows of a file whose stamp is that of the row before: how many, the first one's time, and the spacing that was found."""

    rows: int
    first_s: float
    period_s: float

    @property
    def told(self) -> str:
        """What is to be said of it."""
        bear = "1 row bears" if self.rows == 1 else f"{self.rows} rows bear"
        return (
            f"{bear} the stamp of the row before and readings of their own, first at {self.first_s:.6g} s: stamps are coarser than the "
            f"rows, {self.period_s:.6g} s apart by their number; each has a time now"
        )


@dataclass(frozen=True, eq=False)
class _Stamps:
    """Different stamps t_s (m,), the row of each one's first sample (m,), how many rows bear it (m,); `begins` (m,) behind a gap."""

    t_s: Array
    rows: NDArray[np.int64]
    counts: NDArray[np.int64]
    begins: NDArray[np.bool_]


def own_times(t_s: Array, y: Array, where: str) -> tuple[Array, Spread | None]:
    """The times (n,) with a time of its own for each sample of y (n, outputs), and what was found; as they are where no sample repeats one.

    Raises BadInput where many samples do and nothing tells how far apart they are. Rows whose time goes back stay as they are.
    """
    forward = _forward(t_s)
    times, repeated = t_s[forward], np.diff(t_s[forward]) == 0.0
    if not repeated.any() or not _are_samples(repeated, y[forward]):
        return t_s, None
    first_s, share = float(times[1:][repeated][0]), float(repeated.mean())
    stamps = _stamps(times)
    if len(stamps.t_s) < LEAST_STAMPS:
        return t_s, None
    period_s = _period_s(stamps)
    even = _even(stamps, len(times), period_s) if share > MANY else None
    found = _between(stamps, period_s) if even is None else even
    if found is None:
        if share > MANY:
            raise _untold(where, repeated, stamps, first_s)
        return t_s, None
    counted = t_s.copy()
    counted[forward] = found
    return counted, Spread(int(repeated.sum()), first_s, float(f"{period_s:.6g}"))


def _forward(t_s: Array) -> NDArray[np.int64]:
    """Rows whose stamp is later than all before, and those that repeat such a one just behind it."""
    begins = np.diff(t_s, prepend=np.nan) != 0.0
    later = np.concatenate([[True], t_s[1:] > np.maximum.accumulate(t_s)[:-1]])
    own = np.maximum.accumulate(np.where(begins, np.arange(len(t_s)), 0))
    return np.flatnonzero(later[own])


def _are_samples(repeated: NDArray[np.bool_], y: Array) -> bool:
    """Whether rows with the stamp of the row before bring other readings, nearly as often as rows with a new stamp do."""
    news = ~((y[1:] == y[:-1]) | (np.isnan(y[1:]) & np.isnan(y[:-1]))).all(axis=1)
    within, across = float(news[repeated].mean()), float(news[~repeated].mean()) if not repeated.all() else 1.0
    return within > 0.0 and within >= NEWS * across


def _stamps(times: Array) -> _Stamps:
    rows = np.flatnonzero(np.diff(times, prepend=-np.inf) > 0.0)
    steps = np.diff(times[rows])
    gap = steps > GAP_STAMPS * np.median(steps) if steps.size else np.zeros(0, bool)
    return _Stamps(times[rows], rows, np.diff(rows, append=len(times)), np.concatenate([[True], gap]))


def _pieces(stamps: _Stamps) -> list[slice]:
    """The stamps between gaps."""
    ends = [*np.flatnonzero(stamps.begins).tolist(), len(stamps.t_s)]
    return [slice(*pair) for pair in pairwise(ends)]


def _period_s(stamps: _Stamps) -> float:
    """Slope of time over row by least squares over the first samples of stamps, which are less than a row late; 0 where nothing tells.

    A piece's first stamp may have lost its first samples and tells nothing.
    """
    moment, spread = 0.0, 0.0
    for piece in _pieces(stamps):
        t_s, rows = stamps.t_s[piece][1:], stamps.rows[piece][1:].astype(float)
        if t_s.size:
            moment += float((rows - rows.mean()) @ (t_s - t_s.mean()))
            spread += float((rows - rows.mean()) @ (rows - rows.mean()))
    return moment / spread if spread > 0.0 else 0.0


def _even(stamps: _Stamps, length: int, period_s: float) -> Array | None:
    """Times (length,) that are even between gaps; None where they are further from a stamp than stamps are from one another."""
    found, far_s = np.zeros(length), period_s + float(np.median(np.diff(stamps.t_s)))
    for piece in _pieces(stamps):
        t_s, rows = stamps.t_s[piece], stamps.rows[piece]
        known = slice(1, None) if len(t_s) > 1 else slice(None)
        offset_s = float(np.median(t_s[known] - period_s * rows[known]))
        if np.abs(t_s[known] - offset_s - period_s * rows[known]).max() > far_s:
            return None
        every = np.arange(rows[0], rows[-1] + stamps.counts[piece][-1])
        found[every] = offset_s + period_s * every
    return found


def _between(stamps: _Stamps, period_s: float) -> Array | None:
    """Times with the rows of each stamp spread to the next; None where more rows bear a stamp than that has time for."""
    steps = np.diff(stamps.t_s, append=np.inf)
    if np.any(stamps.counts * period_s > steps + LOST_ROWS * period_s):
        return None
    lost = steps / period_s - stamps.counts > LOST_ROWS
    apart_s = np.where(lost, period_s, steps / stamps.counts)
    place = np.arange(stamps.counts.sum()) - np.repeat(stamps.rows, stamps.counts)
    return np.asarray(np.repeat(stamps.t_s, stamps.counts) + place * np.repeat(apart_s, stamps.counts))


def _untold(where: str, repeated: NDArray[np.bool_], stamps: _Stamps, first_s: float) -> BadInput:
    got = (
        f"{int(repeated.sum())} of {len(repeated) + 1} samples with the stamp of the one before, first at {first_s:.6g} s, from "
        f"{stamps.counts.min()} to {stamps.counts.max()} to a stamp: nothing tells how far apart they are"
    )
    remedy = "write more digits of the time, or say `twinlaw import FILE --column t_s=PERIOD*row`"
    return BadInput("t_s", where, got, "a time for each sample, or evenly spaced ones", remedy)
