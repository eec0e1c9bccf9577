"""Cells of text as numbers: decimal point or comma, what loggers write where nothing was measured, times of day."""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DECIMALS = (".", ",")
# What spreadsheets, MATLAB, R, pandas and loggers write where there is no value.
_WORDS = "nan na n/a #n/a #n/d null none nil - -- --- ? * invalid -nan nan(ind) -nan(ind) 1.#qnan #value! #div/0!"
MISSING = frozenset(("", *_WORDS.split()))
_NUMBER = {
    ".": re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?"),
    ",": re.compile(r"[+-]?(\d+(,\d+)?|,\d+)([eEdD][+-]?\d+)?"),
}
_INFINITE = re.compile(r"[+-]?(inf|infinity|1\.#inf|∞)", re.IGNORECASE)
_CLOCK = re.compile(
    r"(?:\S+[ T])?\s*(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,:]\d+)?))?\s*([AaPp][Mm])?(?:Z|[+-]\d{2}:?\d{2})?"
)
DAY_S = 86400.0


def is_missing(cell: str) -> bool:
    """Whether a cell says that nothing was measured."""
    return cell.lower() in MISSING


def number(cell: str, decimal: str) -> float | None:
    """A cell as a number, NaN where it says that there is none; None for any other text."""
    if _NUMBER[decimal].fullmatch(cell):
        return float(cell.replace(",", ".").replace("d", "e").replace("D", "e"))
    if is_missing(cell):
        return float("nan")
    if _INFINITE.fullmatch(cell):
        return float("-inf") if cell.startswith("-") else float("inf")
    return None


def is_number(cell: str, decimal: str) -> bool:
    """Whether a cell is a number, or a time of day."""
    return _NUMBER[decimal].fullmatch(cell) is not None or time_of_day_s(cell) is not None


def time_of_day_s(cell: str) -> float | None:
    """Seconds since midnight of `17:22:44.123`, with or without a date before it; None for any other text."""
    match = _CLOCK.fullmatch(cell) if ":" in cell else None
    if match is None:
        return None
    hours, minutes, seconds, half = match.groups()
    hour = int(hours) % 12 + (12 if half.lower() == "pm" else 0) if half else int(hours)
    return 3600.0 * hour + 60.0 * int(minutes) + float(re.sub("[,:]", ".", seconds or "0"))


def from_the_first_s(times_s: Sequence[float]) -> Array:
    """Times of day as seconds since the first, past midnight too; NaN stays."""
    times = np.asarray(times_s)
    there = np.flatnonzero(np.isfinite(times))
    times[there] = np.unwrap(times[there], period=DAY_S) - times[there[0]]
    return times
