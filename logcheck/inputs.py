"""Inputs at the plant's limits, beyond them, and held by a limit that is not the plant's."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from logcheck import thresholds
from logcheck.finding import Array, Finding, Found, Rows, in_words
from records.log import RunLog
from records.text.units import unit_of

NEAR_LIMIT = 1e-6  # of the limits' span


@dataclass(frozen=True)
class Saturation:
    """Share of rows in which an input is at (or beyond) its lower and its upper limit."""

    lower: float
    upper: float


def saturations(log: RunLog, limits: Mapping[str, tuple[float, float]]) -> dict[str, Saturation]:
    """Shares at the limits by input."""
    result = {}
    for name in log.columns.inputs:
        low, high = limits.get(name, (-np.inf, np.inf))
        u, margin = log.column(name), _margin(low, high)
        result[name] = Saturation(float(np.mean(u <= low + margin)), float(np.mean(u >= high - margin)))
    return result


def _margin(low: float, high: float) -> float:
    """How near to a limit an input is at it; of limits on one side alone, which have no span, none."""
    return NEAR_LIMIT * (high - low) if np.isfinite(high - low) else 0.0


def input_findings(log: RunLog, name: str, limits: Mapping[str, tuple[float, float]]) -> Iterator[Found]:
    """Notes on how each input lies to its limits, where it has some."""
    shares_of = saturations(log, limits)
    for column, (low, high) in limits.items():
        shares = shares_of[column]
        u, margin = log.column(column), _margin(low, high)
        sides = [(low, shares.lower, u <= low + margin), (high, shares.upper, u >= high - margin)]
        shown = [
            f"{share:.1%} of the rows at {_told(limit, column)}{_when(log.t_s, rows)}"
            for limit, share, rows in sides
            if share > thresholds.SATURATED_SHARE
        ]
        if shown:
            yield _note("saturated", log, name, column, f"{column} is at its limits: {', '.join(shown)}")
        beyond = (u < low - margin) | (u > high + margin)
        if beyond.any():
            at, rows = log.t_s[beyond], in_words(int(beyond.sum()), "row")
            sentence = (
                f"{column} is beyond the plant's limits {low:g}..{_told(high, column)} in {rows}: the plant clips it"
            )
            yield Found(Finding("beyond_limits", name, column, float(at[0]), float(at[-1]), sentence))
        yield from _clipped(log, name, column, low + margin, high - margin)


def _clipped(log: RunLog, name: str, column: str, low: float, high: float) -> Iterator[Found]:
    """Extremes of an input, within the plant's limits, at which it stands again and again."""
    u = log.column(column)
    values, counts = np.unique(u, return_counts=True)
    for place, how in ((-1, "exceeds"), (0, "falls below")):
        extreme, count = values[place], int(counts[place])
        others = np.delete(counts, place)
        if not (
            low < extreme < high
            and others.size
            and count > thresholds.CLIPPED_SHARE * len(u)
            and count > thresholds.COMMONER * others.max()
        ):
            continue
        if _visits(u == extreme) >= thresholds.LEAST_VISITS:
            share = f"where {count / len(u):.1%} of its rows stand"
            why = "it was cut off before it was logged, or the controller has a limit of its own"
            yield _note(
                "clipped", log, name, column, f"{column} never {how} {extreme:.5g} {unit_of(column)}, {share}: {why}"
            )


def _visits(rows: Rows) -> int:
    """How many times rows begin to be true."""
    return int(rows[0]) + int(np.sum(rows[1:] & ~rows[:-1]))


def _told(value: float, column: str) -> str:
    return f"{value:g} {unit_of(column)}".rstrip()


def _when(t_s: Array, rows: Rows) -> str:
    """From when to when, for rows that are one stretch."""
    at = t_s[rows]
    return f", all from {at[0]:.6g} s to {at[-1]:.6g} s" if 1 < len(at) < len(t_s) and _visits(rows) == 1 else ""


def _note(kind: str, log: RunLog, name: str, column: str, sentence: str) -> Found:
    return Found(Finding(kind, name, column, float(log.t_s[0]), float(log.t_s[-1]), sentence))
