"""Long logs by stretches: as many rows as a search can hold, chosen by where and how much moves, never by how the plant fits them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from records.log import RunLog

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]
MOST_READINGS = 40_000  # rows times outputs, of all logs together
STRETCHES = 8
LEAST_S = 10.0  # of a stretch, as long as its log may have that much


@dataclass(frozen=True, eq=False)
class Stretches:
    """Parts of logs with their names and which of their rows (n,) may be used, and a sentence for each log that was cut."""

    logs: tuple[RunLog, ...]
    names: tuple[str, ...]
    used: tuple[Rows, ...]
    notes: tuple[str, ...]


def stretches(logs: Sequence[RunLog], used: Sequence[Rows], names: Sequence[str]) -> Stretches:
    """The logs as they are where they hold at most MOST_READINGS, else equal parts of them that keep their own times.

    Half of a log's parts are spread evenly over it from its beginning to its end; the others are those of the rest in which outputs
    and inputs travel furthest.
    """
    if sum(log.y.size for log in logs) <= MOST_READINGS:
        return Stretches(tuple(logs), tuple(names), tuple(used), ())
    parts: list[tuple[RunLog, str, Rows]] = []
    notes = []
    for log, mask, name, rows in zip(logs, used, names, _shares(logs), strict=True):
        if rows == len(log.t_s):
            parts.append((log, name, mask))
            continue
        chosen = _chosen(log, rows)
        parts += [(_part(log, part), f"{name} from {log.t_s[part.start]:.6g} s", mask[part]) for part in chosen]
        kept = sum(part.stop - part.start for part in chosen)
        spans = ", ".join(f"{log.t_s[part.start]:.6g}..{log.t_s[part.stop - 1]:.6g} s" for part in chosen)
        notes.append(f"{name}: {kept} of its {len(log.t_s)} rows were looked at, as {len(chosen)} stretches: {spans}")
    cut, called, masks = zip(*parts, strict=True)
    return Stretches(cut, called, masks, tuple(notes))


def _shares(logs: Sequence[RunLog]) -> list[int]:
    """Rows that each log may show: short logs all of theirs, the long ones equal parts of what is left."""
    shares = [0] * len(logs)
    left = MOST_READINGS // logs[0].y.shape[1]
    order = sorted(range(len(logs)), key=lambda index: len(logs[index].t_s))
    for taken, index in enumerate(order):
        shares[index] = min(len(logs[index].t_s), left // (len(logs) - taken))
        left -= shares[index]
    return shares


def _chosen(log: RunLog, rows: int) -> list[slice]:
    """Parts of together at most `rows` rows, in order of time."""
    n = len(log.t_s)
    parts = int(np.clip(rows * log.sample_period_s / LEAST_S, 1, STRETCHES))
    size = max(rows // parts, 1)
    count = n // size
    starts = np.linspace(0, n - size, count).astype(int)
    even = np.unique(np.linspace(0, count - 1, (parts + 1) // 2).astype(int))
    travelled = _travelled(log)
    lively = np.argsort([travelled[start] - travelled[start + size - 1] for start in starts], kind="stable")
    others = [int(place) for place in lively if place not in even][: parts - len(even)]
    return [slice(int(starts[place]), int(starts[place]) + size) for place in sorted([*even.tolist(), *others])]


def _travelled(log: RunLog) -> Array:
    """The way (n,) of all inputs and outputs so far, each in units of how far it is usually from its mean."""
    columns = np.column_stack([log.u, log.y])
    usual = np.nanstd(columns, axis=0)
    way = np.nan_to_num(np.abs(np.diff(columns, axis=0))) / np.where(usual > 0.0, usual, np.inf)
    return np.asarray(np.concatenate([[0.0], np.cumsum(way.sum(axis=1))]))


def _part(log: RunLog, rows: slice) -> RunLog:
    extra = {name: column[rows] for name, column in log.extra.items()}
    seq = None if log.seq is None else log.seq[rows]
    return replace(log, t_s=log.t_s[rows], u=log.u[rows], y=log.y[rows], extra=extra, seq=seq)
