"""Tables of numbers as text, as loggers and spreadsheets leave them: decimal commas, stray columns, lost characters."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput

Array = NDArray[np.float64]


def cells(content: bytes, separator: str | None, where: str) -> tuple[tuple[str, ...], list[list[str]]]:
    """Header and rows of stripped cells; empty lines are passed over, `separator` None is white space.

    Bytes beyond ASCII (an accent in a remark) are replaced, as no number holds one. Raises BadInput without rows.
    """
    lines = [line for line in content.decode("ascii", errors="replace").splitlines() if line.strip()]
    table = [[cell.strip() for cell in line.split(separator)] for line in lines]
    if len(table) < 2:
        raise BadInput("recording", where, f"{len(table)} lines", "a header and rows", "fetch the file again")
    return tuple(table[0]), table[1:]


def column(header: Sequence[str], rows: Sequence[Sequence[str]], name: str, where: str) -> Array:
    """The numbers (rows,) under `name`, with decimal point or comma; raises BadInput naming the row of a cell that is none."""
    return np.array([number(text, where, line) for line, text in enumerate(texts(header, rows, name, where), start=2)])


def texts(header: Sequence[str], rows: Sequence[Sequence[str]], name: str, where: str) -> list[str]:
    """The cells under `name` as they stand; raises BadInput when there is no such column or a row ends before it."""
    if name not in header:
        raise BadInput(f"column {name!r}", where, ", ".join(header), f"{name!r} among them", "fetch the file again")
    place = header.index(name)
    for line, row in enumerate(rows, start=2):
        if len(row) <= place:
            raise BadInput("row", f"{where}, line {line}", f"{len(row)} cells", f"{place + 1}", "fetch the file again")
    return [row[place] for row in rows]


def number(text: str, where: str, line: int) -> float:
    """A cell as a number, the comma being a decimal comma; raises BadInput."""
    try:
        return float(text.replace(",", "."))
    except ValueError as error:
        raise BadInput("number", f"{where}, line {line}", repr(text), "a number", "fetch the file again") from error
