"""Cells of text as numbers: decimal point or comma, what loggers write where nothing was measured, times of day."""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from recordings.units import known

Array = NDArray[np.float64]

DECIMALS = (".", ",")
# What spreadsheets, MATLAB, R, pandas and loggers write where there is no value.
_WORDS = (
    "nan na n/a n.a. null none nil - -- --- . ? * invalid missing -nan nan(ind) -nan(ind) nan(snan) -nan(snan) "
    "1.#qnan -1.#qnan 1.#snan -1.#snan 1.#ind -1.#ind"
)
MISSING = frozenset(("", *_WORDS.split()))
_ERROR = re.compile(r"#[^\d\s]\S*")  # of a spreadsheet, in any language: #N/A, #NV, #WERT!, #VALEUR!
_NUMBER = {
    ".": re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?"),
    ",": re.compile(r"[+-]?(\d+(,\d+)?|,\d+)([eEdD][+-]?\d+)?"),
}
# Digits in groups of three, as spreadsheets write thousands: 1.234,56 in one country and 1,234.56, 1'234.56 or 1 234.56 in others.
_GROUPS = {
    decimal: re.compile(
        rf"[+-]?[1-9]\d{{0,2}}(?P<sign>[{signs}'’ ])\d{{3}}(?P<more>(?P=sign)\d{{3}})*(?P<part>{point}\d+)?"
    )
    for decimal, signs, point in ((".", ",", r"\."), (",", ".", ","))
}
_HEXADECIMAL = re.compile(r"0[xX][0-9a-fA-F]+")
_INFINITE = re.compile(r"[+-]?(inf|infinity|1\.#inf|∞)", re.IGNORECASE)
_CLOCK = re.compile(
    r"(?:[\w.,/ -]*[\w.][ T_-])?\s*(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,:]\d+)?))?\s*([AaPp][Mm])?"
    r"(?:Z|([+-]\d{2}):?(\d{2})| ?UTC| ?GMT| \d{4})?"
)
_BASIC = re.compile(r"\d{8}T(\d{2})(\d{2})(\d{2}(?:[.,]\d+)?)()(?:Z|([+-]\d{2}):?(\d{2}))?")  # ISO 8601 without signs
_MINUTES = re.compile(r"()(\d{1,3}):(\d{2}[.,]\d+)()()()")  # 58:01.5, as spreadsheets show an hour's times
_WITH_UNIT = re.compile(r"([+-]?[\d.,'’ ]*[\d.,](?:[eE][+-]?\d+)?) ?([^\d\s.,eE+-]\S*)")
DAY_S = 86400.0


def is_missing(cell: str) -> bool:
    """Whether a cell says that nothing was measured."""
    return cell.lower() in MISSING or _ERROR.fullmatch(cell) is not None


def number(cell: str, decimal: str) -> float | None:
    """A cell as a number, NaN where it says that there is none; None for any other text."""
    if _NUMBER[decimal].fullmatch(cell):
        return float(cell.replace(",", ".").replace("d", "e").replace("D", "e"))
    if is_missing(cell):
        return float("nan")
    if is_grouped(cell, decimal):
        return number(without_groups(cell, decimal), decimal)
    if _HEXADECIMAL.fullmatch(cell):
        return float(int(cell, 16))
    if _INFINITE.fullmatch(cell):
        return float("-inf") if cell.startswith("-") else float("inf")
    return None


def is_number(cell: str, decimal: str) -> bool:
    """Whether a cell is a number, by itself or with its unit, or a time of day."""
    plain = _NUMBER[decimal].fullmatch(cell) or _HEXADECIMAL.fullmatch(cell) or is_grouped(cell, decimal)
    return bool(plain) or time_of_day_s(cell) is not None or number_and_unit(cell, decimal) is not None


def is_grouped(cell: str, decimal: str) -> bool:
    """Whether a cell can be nothing but a number with its thousands apart; `1,234` may be one with a decimal comma as well."""
    match = _GROUPS[decimal].fullmatch(cell)
    return match is not None and (match["sign"] not in DECIMALS or bool(match["more"]) or bool(match["part"]))


def may_be_grouped(cell: str, decimal: str) -> bool:
    """Whether a cell is no number but for thousands that stand apart: `1.234` where the comma is the decimal sign."""
    return _NUMBER[decimal].fullmatch(cell) is None and _GROUPS[decimal].fullmatch(cell) is not None


def without_groups(cell: str, decimal: str) -> str:
    """A number without the signs between its thousands; any other text as it is."""
    match = _GROUPS[decimal].fullmatch(cell)
    return cell.replace(match["sign"], "") if match else cell


def number_and_unit(cell: str, decimal: str) -> tuple[str, str] | None:
    """The number of a cell such as `4.9 V` or `1,234.5 mV`, its thousands together, and its known unit; None for any other text."""
    match = _WITH_UNIT.fullmatch(cell)
    if match is None or known(match[2]) is None:
        return None
    text = without_groups(match[1], decimal) if is_grouped(match[1], decimal) else match[1]
    return (text, match[2]) if _NUMBER[decimal].fullmatch(text) else None


def time_of_day_s(cell: str) -> float | None:
    """Seconds since midnight of `17:22:44.123`, with or without a date before it, in UTC where it states how far it is off; else None."""
    forms = (_CLOCK, _MINUTES) if ":" in cell else (_BASIC,) if "T" in cell else ()
    match = next((match for form in forms if (match := form.fullmatch(cell))), None)
    if match is None:
        return None
    hours, minutes, seconds, half, off_h, off_min = match.groups()
    hour = int(hours) % 12 + (12 if half.lower() == "pm" else 0) if half else int(hours or 0)
    off_s = 3600.0 * int(off_h) + (-60.0 if off_h.startswith("-") else 60.0) * int(off_min) if off_h else 0.0
    return 3600.0 * hour + 60.0 * int(minutes) + float(re.sub("[,:]", ".", seconds or "0")) - off_s


def from_the_first_s(times_s: Sequence[float]) -> Array:
    """Times of day as seconds since the first, past midnight too; NaN stays."""
    times = np.asarray(times_s)
    there = np.flatnonzero(np.isfinite(times))
    times[there] = np.unwrap(times[there], period=DAY_S) - times[there[0]]
    return times
