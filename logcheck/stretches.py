"""Dense logs by rows as a plant needs them, then long ones by stretches: as many rows as a search can hold, chosen by where and how much
moves, never by how the plant fits them.

A recording and the same with half of its rows, inputs averaged, tell the same where both are denser than that.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from records.log import RunLog
from records.reasons import Note
from sim.substeps import ACCURATE_STEP

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]
PERIOD_ROUNDED = 1e-6  # of a sample period, that a file may state it wrong by


@dataclass(frozen=True, eq=False)
class Stretches:
    """Parts of logs with their names and which of their rows (n,) may be used, and a note for each log that was cut.

    `of` are the names of the logs that they are parts of.
    """

    logs: tuple[RunLog, ...]
    names: tuple[str, ...]
    used: tuple[Rows, ...]
    notes: tuple[Note, ...]
    of: tuple[str, ...]


def stretches(logs: Sequence[RunLog], used: Sequence[Rows], names: Sequence[str], rate_rad_s: float) -> Stretches:
    """The logs, thinned where they are many and denser than a plant of that fastest rate needs; whole where they then hold at most
    MOST_READINGS, else equal parts of them that keep their own times.

    Half of a log's parts are spread evenly over it from its beginning to its end; the others are those of the rest in which outputs
    and inputs travel furthest.
    """
    spare = sum(len(log.t_s) for log in logs) // thresholds.ENOUGH_ROWS
    every = [max(min(_every(log, rate_rad_s), spare), 1) for log in logs]
    if max(every, default=1) == 1 and sum(log.y.size for log in logs) <= thresholds.MOST_READINGS:
        return Stretches(tuple(logs), tuple(names), tuple(used), (), tuple(names))
    kept = [_one_in(mask, factor) for mask, factor in zip(used, every, strict=True)]
    shown = [_thinned(log, rows) if factor > 1 else log for log, rows, factor in zip(logs, kept, every, strict=True)]
    parts: list[tuple[RunLog, str, Rows, str]] = []
    notes = []
    for log, whole, mask, name, places, rows in zip(shown, logs, used, names, kept, _shares(shown), strict=True):
        left = mask[places]
        if log is not whole:
            apart = f"{whole.sample_period_s * 1e6:.4g} microseconds apart"
            said = f"{name}: {len(log.t_s)} of its {len(mask)} rows were looked at, spread evenly, as they are {apart}"
            notes.append(Note("thinned", name, {"rows": len(log.t_s), "of_rows": len(mask)}, said))
        if rows == len(log.t_s):
            parts.append((log, name, left, name))
            continue
        chosen = _chosen(log, rows)
        parts += [(part(log, span), stretch_name(log, name, span), left[span], name) for span in chosen]
        spans_s = [(float(log.t_s[span.start]), float(log.t_s[span.stop - 1])) for span in chosen]
        notes.append(Note("stretches", name, {"spans_s": spans_s}, f"{name}: {_kept(log, chosen)}"))
    cut, called, masks, of = zip(*parts, strict=True)
    return Stretches(cut, called, masks, tuple(notes), of)


def _kept(log: RunLog, chosen: Sequence[slice]) -> str:
    """Which rows are looked at, in words."""
    rows = sum(part.stop - part.start for part in chosen)
    spans = ", ".join(f"{log.t_s[part.start]:.6g}..{log.t_s[part.stop - 1]:.6g} s" for part in chosen)
    how_many = "1 stretch" if len(chosen) == 1 else f"{len(chosen)} stretches"
    return f"{rows} of its {len(log.t_s)} rows were looked at, as {how_many}: {spans}"


def _every(log: RunLog, rate_rad_s: float) -> int:
    """The factor by which a log may be thinned: its rows are then ACCURATE_STEP of the plant's shortest time constant apart, or COARSEST_S.
    The filter follows what moves between them by the equations, but knows of inputs their mean alone: of rows a whole time constant apart
    that is too little, and looks like a delay."""
    apart_s = min(thresholds.COARSEST_S, ACCURATE_STEP / rate_rad_s if rate_rad_s > 0.0 else np.inf)
    return int(apart_s / log.sample_period_s + PERIOD_ROUNDED)


def _one_in(used: Rows, factor: int) -> NDArray[np.int64]:
    """The first row that may be used of each `factor` rows; where none may be, their first."""
    padded = np.pad(used, (0, -len(used) % factor)).reshape(-1, factor)
    return np.asarray(np.arange(len(padded)) * factor + np.argmax(padded, axis=1))


def _thinned(log: RunLog, rows: NDArray[np.int64]) -> RunLog:
    """Some rows of a log, with the mean of the inputs from each to the next."""
    count = np.diff([*rows, len(log.t_s)])
    return replace(
        log,
        sample_period_s=float(log.t_s[rows[-1]] - log.t_s[rows[0]]) / (len(rows) - 1),
        t_s=log.t_s[rows],
        u=np.add.reduceat(log.u, rows, axis=0) / count[:, np.newaxis],
        y=log.y[rows],
        extra={name: column[rows] for name, column in log.extra.items()},
        seq=None,  # its numbers would tell of lost samples
    )


def _shares(logs: Sequence[RunLog]) -> list[int]:
    """Rows that each log may show: short logs all of theirs, the long ones equal parts of what is left."""
    shares = [0] * len(logs)
    left = thresholds.MOST_READINGS // logs[0].y.shape[1]
    order = sorted(range(len(logs)), key=lambda index: len(logs[index].t_s))
    for taken, index in enumerate(order):
        shares[index] = min(len(logs[index].t_s), left // (len(logs) - taken))
        left -= shares[index]
    return shares


def _chosen(log: RunLog, rows: int) -> list[slice]:
    """Parts of together at most `rows` rows, in order of time."""
    n = len(log.t_s)
    parts = int(np.clip(rows * log.sample_period_s / thresholds.LEAST_STRETCH_S, 1, thresholds.STRETCHES))
    size = max(rows // parts, 1)
    count = n // size
    starts = np.linspace(0, n - size, count).astype(int)
    even = np.unique(np.linspace(0, count - 1, (parts + 1) // 2).astype(int))
    travelled = _travelled(log)
    lively = np.argsort([travelled[start] - travelled[start + size - 1] for start in starts], kind="stable")
    others = [int(place) for place in lively if place not in even][: parts - len(even)]
    return [slice(int(starts[place]), int(starts[place]) + size) for place in sorted([*even.tolist(), *others])]


def _travelled(log: RunLog) -> Array:
    """The way (n,) of all inputs and outputs so far, each in units of how far it is usually from its mean; 0 for one never measured."""
    columns = np.column_stack([log.u, log.y])
    columns = columns[:, np.isfinite(columns).any(axis=0)]
    usual = np.nanstd(columns, axis=0)
    way = np.nan_to_num(np.abs(np.diff(columns, axis=0))) / np.where(usual > 0.0, usual, np.inf)
    return np.asarray(np.concatenate([[0.0], np.cumsum(way.sum(axis=1))]))


def stretch_name(log: RunLog, name: str, rows: slice) -> str:
    """What a stretch of a log is called: a note on it may add times of its own."""
    return f"{name} (from {log.t_s[rows.start]:.6g} s)"


def part(log: RunLog, rows: slice) -> RunLog:
    """Some consecutive rows of a log, as a log with its own times."""
    extra = {name: column[rows] for name, column in log.extra.items()}
    seq = None if log.seq is None else log.seq[rows]
    return replace(log, t_s=log.t_s[rows], u=log.u[rows], y=log.y[rows], extra=extra, seq=seq)
