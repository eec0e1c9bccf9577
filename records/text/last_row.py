"""The last row of a table: a logger whose supply failed wrote it in part."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

CHARACTERS_SHOWN = 60
ROWS_BEFORE = 400  # rows before it that show how its last number is written
LEAST_EXPONENT = 2  # digits that C, Python, MATLAB write of an exponent at least
LEAST_DIGITS = 5  # that a tool prints which counts a number's digits, and not its decimals: dlmwrite of MATLAB
FLOAT32_DIGITS = 9  # that tell every float32 from its neighbours


@dataclass(frozen=True)
class HalfRow:
    """The last line of a file, which was not written to its end and is left out: its number, and what stands there."""

    line: int
    text: str

    @property
    def told(self) -> str:
        """What is to be said of it."""
        shown = self.text if len(self.text) <= CHARACTERS_SHOWN else f"{self.text[:CHARACTERS_SHOWN]}..."
        return f"line {self.line}, the last, was not written to its end, or may not have been: {shown!r}; left out"


@dataclass(frozen=True)
class _Written:
    """How a number is written: its digits from the first that is not 0, those in front of the decimal sign, behind it, of its exponent."""

    digits: int
    whole: int
    decimals: int
    exponent: int


def may_be_cut(last: str, others: Sequence[str], decimal: str = ".") -> bool:
    """Whether a cell at the end of a text, without a line end behind it, may have lost digits; `others` stand above it in its column.

    It has not where it repeats the one above, has as many decimals as any of the others or, where these vary, as many digits as any or as
    tell a float32; a whole number has not where it, and not what it may be the beginning of, goes on from the one above. Fewer decimals
    may be a number's own, too: nobody knows.
    """
    numbers = [cell for cell in others if any(map(str.isdigit, cell))]
    if not numbers or last == others[-1] or last.isalpha():
        return False
    if not (last[-1:] + numbers[-1][-1]).isdigit():  # a unit or a quotation mark stands behind
        return last[-1:] != numbers[-1][-1]
    own, above = _written(last, decimal), [_written(cell, decimal) for cell in numbers]
    decimals, digits = [entry.decimals for entry in above], [entry.digits for entry in above]
    exponent = max(entry.exponent for entry in above)
    if own.exponent:
        return own.exponent < max(exponent, LEAST_EXPONENT)
    if own.whole == 1 and (exponent or not any(entry.whole for entry in above)):
        return True
    if not own.decimals and not any(decimals):
        return not _goes_on(_whole(last), [_whole(cell) for cell in numbers])
    varies, enough = min(decimals) < max(decimals), min(max(LEAST_DIGITS, *digits), FLOAT32_DIGITS)
    return own.decimals < max(decimals) and not (varies and own.digits >= enough)


def _written(cell: str, decimal: str) -> _Written:
    mantissa, _, exponent = cell.lower().partition("e")
    whole, _, decimals = mantissa.partition(decimal)
    digits = "".join(filter(str.isdigit, mantissa)).lstrip("0")
    return _Written(len(digits), len(whole.lstrip("+-0")), len(decimals), sum(map(str.isdigit, exponent)))


def _whole(cell: str) -> int:
    """A number without decimals, whatever stands between its thousands."""
    return int("".join(sign for sign in cell if sign.isdigit() or sign == "-"))


def _goes_on(last: int, above: Sequence[int]) -> bool:
    """Whether a whole number is no farther from the one above than these from one another, and ten times that number is."""
    most = max((abs(after - before) for before, after in pairwise(above)), default=0)
    return abs(last - above[-1]) <= most and (not last or abs(10 * last - above[-1]) > most)


def without_half_row(body: str, width: int) -> tuple[str, HalfRow | None]:
    """The rows below a header of `width` cells, separated by commas, without a last one that was written in part, and that one.

    A last line is whole where it has all cells and ends as a line does, or its last number cannot have lost digits. An only row stays.
    """
    lines = body.rstrip("\n").split("\n")
    before = [line for line in lines[:-1] if line.strip()]
    if not before:
        return body, None
    last, others = lines[-1], [line.rpartition(",")[2].strip() for line in before[-ROWS_BEFORE:]]
    cells = last.split(",")
    is_short = len(cells) < width
    is_open = not body.endswith("\n") and (not _is_number(cells[-1]) or may_be_cut(cells[-1].strip(), others))
    if len(cells) > width or not (is_short or is_open):
        return body, None
    return "\n".join(lines[:-1]) + "\n", HalfRow(len(lines) + 1, last)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
