"""Rows of numbers as CSV: fast where the file is clean, precise about the line where it is not."""

import io
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.text.last_row import HalfRow, without_half_row
from records.text.reading import read_text

Array = NDArray[np.float64]


def rows_text(names: Sequence[str], columns: Sequence[Array], seq: NDArray[np.int64] | None) -> str:
    """Header and rows of columns (n,), `seq` (n,) first if given; each number in its shortest form that reads back exactly."""
    cells = [map(repr, column.tolist()) for column in columns]
    if seq is not None:
        names, cells = ["seq", *names], [map(repr, seq.tolist()), *cells]
    lines = [",".join(names), *map(",".join, zip(*cells, strict=True))]
    return "\n".join(lines) + "\n"


def read_rows(path: Path) -> tuple[tuple[str, ...], Array]:
    """Header and numbers (rows, columns) of a CSV file; an empty cell reads as NaN. Raises BadInput naming the line.

    A header that stands again, where files were laid one behind the other, is passed over.
    """
    names, body = _header_and_body(path)
    return names, _numbers(body, names, path)


def read_whole_rows(
    path: Path, check_header: Callable[[tuple[str, ...]], None]
) -> tuple[tuple[str, ...], Array, HalfRow | None]:
    """The same without a last row that was written in part, and that one.

    `check_header` sees the header before any row is read: what is no log at all is named as that, not by its first row.
    """
    names, body = _header_and_body(path)
    check_header(names)
    body, half = without_half_row(body, len(names))
    return names, _numbers(body, names, path), half


def _header_and_body(path: Path) -> tuple[tuple[str, ...], str]:
    text = read_text(path, "run log")
    header, _, body = text.partition("\n")
    if not header.strip() or not body.strip():
        got = "an empty file" if not header.strip() else "a header only"
        raise BadInput("run log", str(path), got, "a header and rows of numbers", "record at least one sample")
    return tuple(name.strip() for name in header.split(",")), body


def _numbers(body: str, names: tuple[str, ...], path: Path) -> Array:
    try:
        rows = np.loadtxt(io.StringIO(body), delimiter=",", ndmin=2, comments=None)
    except ValueError:
        return _slow_rows(body, names, path)
    if rows.shape[1] != len(names):
        raise _row_length(path, 2, rows.shape[1], len(names))
    return rows


def _slow_rows(body: str, names: tuple[str, ...], path: Path) -> Array:
    """Line by line, for a file with empty cells or a second header, or with the first wrong cell named."""
    lines = [(number, line) for number, line in enumerate(body.split("\n"), start=2) if line.strip()]
    lines = [(number, line) for number, line in lines if tuple(name.strip() for name in line.split(",")) != names]
    width = len(names)
    rows = np.empty((len(lines), width))
    for index, (number, line) in enumerate(lines):
        cells = line.split(",")
        if len(cells) != width:
            raise _row_length(path, number, len(cells), width)
        rows[index] = [_number(cell, path, number) for cell in cells]
    return rows


def _number(cell: str, path: Path, line: int) -> float:
    try:
        return float(cell) if cell.strip() else float("nan")
    except ValueError as error:
        where = f"{path}, line {line}"
        raise BadInput(
            "number",
            where,
            repr(cell[:30]),
            "a number such as -0.125",
            "use decimal points and nan, or `twinlaw import` it",
        ) from error


def _row_length(path: Path, line: int, got: int, expected: int) -> BadInput:
    remedy = "the row is truncated: remove it"
    if got > expected:
        remedy = "give what follows as a log of its own where another table begins there; `twinlaw import` reads decimal commas"
    return BadInput("row", f"{path}, line {line}", f"{got} cells", f"{expected}, as the header", remedy)
