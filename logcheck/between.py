"""What two logs say about each other: the same rows twice, or two rigs."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from logcheck import thresholds
from logcheck.finding import EXCLUDE, NOTE, REFUSE, Array, Finding, Found, Rows
from records.log import RunLog

Hashes = NDArray[np.uint64]


def shared_rows(one: RunLog, other: RunLog) -> Rows:
    """Rows (n,) of `other` that stand in `one` too, within at least 32 rows in a row that do, whatever their times.

    Some input changes within such rows: from a state that comes again, a plant under the same constant inputs goes the same way again,
    reading for reading where these are coarse. Where none ever changes, as in free swings, they are more than a common way would be.
    """
    mine, theirs = _windows(one), _windows(other)
    n = len(other.t_s)
    if not mine.size or not theirs.size:
        return np.zeros(n, bool)
    begins = np.flatnonzero((theirs != 0) & np.isin(theirs, mine[mine != 0]))
    edges = np.zeros(n + 1, np.int64)
    np.add.at(edges, begins, 1)
    np.add.at(edges, begins + 2**thresholds.WINDOW_DOUBLINGS, -1)
    rows: Rows = np.cumsum(edges[:-1]) > 0
    changes: Rows = np.concatenate([[False], (np.diff(other.u, axis=0) != 0.0).any(axis=1)])
    if changes.any():
        return rows & _runs_with(rows, changes)
    return rows if rows.mean() > thresholds.BEGINS_ALIKE else np.zeros_like(rows)


def _runs_with(rows: Rows, some: Rows) -> Rows:
    """The rows (n,) in runs of `rows` of which a row behind the first is one of `some`."""
    first = rows & ~np.concatenate([[False], rows[:-1]])
    run = np.cumsum(first)
    return np.isin(run, run[rows & some & ~first])


def _windows(log: RunLog) -> Hashes:
    """A hash of each window of rows, of inputs and outputs; 0 for windows in which hardly anything changes."""
    rows = np.ascontiguousarray(np.hstack([log.u, log.y]) + 0.0).view(np.uint64)
    hashes = np.zeros(len(rows), np.uint64)
    for column in rows.T:
        hashes = _mixed(hashes, column)
    changes = np.concatenate([[0], np.cumsum(hashes[1:] != hashes[:-1])])
    for doubling in range(thresholds.WINDOW_DOUBLINGS):
        width = 2**doubling
        if len(hashes) <= width:
            return np.zeros(0, np.uint64)
        hashes = _mixed(hashes[:-width], hashes[width:])
    changed = changes[2**thresholds.WINDOW_DOUBLINGS - 1 :] - changes[: len(hashes)]
    return np.where(changed >= thresholds.LEAST_SHARED_CHANGES, hashes | np.uint64(1), np.uint64(0))


def _mixed(one: Hashes, other: Hashes) -> Hashes:
    """Two words into one, each bit on many (the multiplier is 2^64 over the golden ratio)."""
    product = (one ^ (other * np.uint64(0x9E3779B97F4A7C15))) + np.uint64(0x632BE59BD9B4E019)
    product = (product ^ (product >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return np.asarray(product ^ (product >> np.uint64(32)))


def duplicate_findings(
    logs: Sequence[RunLog], names: Sequence[str], holdout: Sequence[RunLog], holdout_names: Sequence[str]
) -> Iterator[tuple[int, Found]]:
    """Rows that stand twice: refused between training and hold-out, the later ones left out within training. Index of the log, finding."""
    for index, log in enumerate(logs):
        for earlier in range(index):
            rows = shared_rows(logs[earlier], log)
            if rows.any():
                sentence = f"{int(rows.sum())} rows stand in {names[earlier]} too; left out here"
                yield index, _found("duplicate_rows", log, names[index], rows, sentence, EXCLUDE)
    for index, (held, held_name) in enumerate(zip(holdout, holdout_names, strict=True), len(logs)):
        for log, name in zip(logs, names, strict=True):
            rows = shared_rows(log, held)
            alike = _alike_at_first(log, held)
            if rows[alike:].any() or rows.sum() > thresholds.BEGINS_ALIKE * len(rows):
                sentence = f"{int(rows.sum())} rows of the hold-out log stand in {name} too"
                yield index, _found("holdout_overlap", held, held_name, rows, sentence, REFUSE)
            elif rows.any():
                sentence = f"its first {alike} rows are those of {name} too: both begin with the same manoeuvre, reading for reading"
                yield index, _found("begins_alike", held, held_name, rows, sentence, NOTE)


def _alike_at_first(one: RunLog, other: RunLog) -> int:
    """How many rows from the first on two logs have in common, as flights of a simulation or a coarse sensor that begin alike have."""
    rows = min(len(one.t_s), len(other.t_s))
    same = (one.u[:rows] == other.u[:rows]).all(axis=1) & (one.y[:rows] == other.y[:rows]).all(axis=1)
    return rows if same.all() else int(np.argmin(same))


def _found(kind: str, log: RunLog, name: str, rows: Rows, sentence: str, severity: str) -> Found:
    at = log.t_s[rows]
    expected, remedy = "a hold-out run of its own", "record another run, or give it only once"
    finding = Finding(
        kind, name, None, float(at[0]), float(at[-1]), sentence, severity, int(rows.sum()), expected, remedy
    )
    return Found(finding, rows if severity == EXCLUDE else None)


def plant_pair_findings(logs: Sequence[RunLog], names: Sequence[str]) -> Iterator[tuple[int, Found]]:
    """Logs that need another input to hold the same angle, on the first axis, than the first log does."""
    if not logs[0].columns.inputs:
        return
    for index in range(1, len(logs)):
        ratio = holding_ratio(logs[0], logs[index])
        if ratio is None or 1.0 / thresholds.NOTE_RATIO < ratio < thresholds.NOTE_RATIO:
            continue
        log, column = logs[index], logs[index].columns.inputs[0]
        sentence = f"{column} that holds the same {log.columns.outputs[0]} is {ratio:.3g} times that of {names[0]}"
        sentence += ": friction holds it at rest, or the plant was changed"
        span = (float(log.t_s[0]), float(log.t_s[-1]))
        yield (
            index,
            Found(
                Finding(
                    "two_plants",
                    names[index],
                    column,
                    *span,
                    sentence,
                    NOTE,
                    0,
                    "logs of one rig",
                    "give the logs of one rig at a time",
                )
            ),
        )


def holding_ratio(one: RunLog, other: RunLog) -> float | None:
    """Median ratio of the first inputs that hold the first output, over angles that both logs rest at; None for too few of them."""
    steady = [_steady(log) for log in (one, other)]
    angles = [log.y[rows, 0] for log, rows in zip((one, other), steady, strict=True)]
    if min(len(values) for values in angles) < thresholds.LEAST_STEADY_ROWS:
        return None
    low, high = max(values.min() for values in angles), min(values.max() for values in angles)
    if not low < high:
        return None
    edges = np.linspace(low, high, thresholds.ANGLE_BINS + 1)
    worth = thresholds.LEAST_HOLDING_INPUT * max(float(np.abs(log.u[:, 0]).max()) for log in (one, other))
    holding = [
        _by_bin(values, log.u[rows, 0], edges) for values, log, rows in zip(angles, (one, other), steady, strict=True)
    ]
    both = np.isfinite(holding[0]) & np.isfinite(holding[1])
    both &= (np.abs(holding[0]) > worth) & (np.abs(holding[1]) > worth) & (holding[0] * holding[1] > 0.0)
    return float(np.median(holding[1][both] / holding[0][both])) if both.any() else None


def _steady(log: RunLog) -> Rows:
    """Rows in whose surroundings of a second the first output hardly moves."""
    half = max(1, round(0.5 / log.sample_period_s))
    psi, n = log.y[:, 0], len(log.t_s)
    steady = np.zeros(n, bool)
    if n > 2 * half:
        with np.errstate(invalid="ignore"):
            slow = np.abs(psi[2 * half :] - psi[: -2 * half]) < thresholds.STEADY_RAD_S
            slow &= np.abs(psi[half:-half] - psi[: -2 * half]) < thresholds.STEADY_RAD_S
        steady[half:-half] = slow & np.isfinite(psi[half:-half])
    return steady


def _by_bin(angles: Array, u: Array, edges: Array) -> Array:
    """Mean input by bin of the angle; NaN where a bin holds fewer than LEAST_STEADY_ROWS rows."""
    place = np.clip(np.digitize(angles, edges) - 1, 0, thresholds.ANGLE_BINS - 1)
    inside = (angles >= edges[0]) & (angles <= edges[-1])
    count = np.bincount(place[inside], minlength=thresholds.ANGLE_BINS)
    total = np.bincount(place[inside], weights=u[inside], minlength=thresholds.ANGLE_BINS)
    return np.where(count >= thresholds.LEAST_STEADY_ROWS, total / np.maximum(count, 1), np.nan)
