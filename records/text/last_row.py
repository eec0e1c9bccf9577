"""The last row of a table: a logger whose supply failed wrote it in part."""

from collections.abc import Sequence
from dataclasses import dataclass

CHARACTERS_SHOWN = 60
ROWS_BEFORE = 400  # rows before it that show how its last number is written


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


def may_be_cut(last: str, others: Sequence[str], decimal: str = ".") -> bool:
    """Whether a cell at the end of a text, without a line end behind it, may have lost digits.

    It has not where all `others` of its column have as many decimals as it, or the one before is the same; with no others nobody knows.
    """
    if not others or last == others[-1]:
        return False
    own = len(last.partition(decimal)[2])
    return not own or any(len(cell.partition(decimal)[2]) != own for cell in others)


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
