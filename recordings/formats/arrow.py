"""Tables of Apache Arrow and its relatives, Parquet, Feather and ORC, by way of the optional package pyarrow."""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from recordings.formats.bags.messages import LONGEST_ARRAY
from recordings.formats.clocks import with_clocks
from recordings.formats.optional import package
from recordings.formats.text.cells import from_the_first_s, is_missing, number, time_of_day_s
from recordings.formats.text.headings import name_and_unit
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal
from records.errors import BadInput

READERS = {
    ".parquet": ("pyarrow.parquet", "Parquet"),
    ".feather": ("pyarrow.feather", "Feather"),
    ".arrow": ("pyarrow.feather", "Arrow"),  # Feather's second version is Arrow's file
    ".orc": ("pyarrow.orc", "ORC"),
}
_NS = 1e-9


def read(path: Path, asked: TextLayout) -> Contents:
    """The columns of numbers, those of a structure behind a point, entries of arrays as `name[0]`, dates in seconds from the first.

    Raises BadInput when pyarrow is not installed, and for a file of another kind.
    """
    reader, called = READERS[path.suffix.lower()]
    package("pyarrow", "parquet", path)
    read_table = package(reader, "parquet", path).read_table
    try:
        table = read_table(path)
    except FileNotFoundError as error:
        raise BadInput(f"{called} file", str(path), "no such file", "a readable file", "check the path") from error
    except Exception as error:  # as many classes as the package has parts
        expected = f"a {path.suffix} file"
        raise BadInput(f"{called} file", str(path), f"no {called} ({error})", expected, "export it again") from error
    while any(str(field.type).startswith("struct") for field in table.schema):
        table = table.flatten()
    signals: dict[str, Signal] = {}
    unread: dict[str, str] = {}
    for name, unit, heading, column in _columns(table):
        values, stated = _of_text(column) if "string" in str(column.type) else _numbers(column)
        if values is None:
            unread[name] = f"of the type {column.type}, no numbers"
        else:
            signals[name] = Signal(values, stated or unit, heading=heading, instants=stated == "s")
    return Contents(with_clocks(signals), unread=unread)


def _columns(table: Any) -> Iterator[tuple[str, str, str, Any]]:
    """The columns with name, unit and heading, arrays of one length one entry after another."""
    compute = import_module("pyarrow.compute")
    for heading, column in zip(table.column_names, table.columns, strict=True):
        name, unit = name_and_unit(heading)
        lengths = compute.list_value_length(column).unique().to_pylist() if "list" in str(column.type) else [None]
        if len(lengths) == 1 and lengths[0] is not None and lengths[0] <= LONGEST_ARRAY:
            for index in range(lengths[0]):
                yield f"{name}[{index}]", unit, f"{heading}[{index}]", compute.list_element(column, index)
        else:
            yield name, unit, heading, column


def _numbers(column: Any) -> tuple[np.ndarray | None, str]:
    """The values as floats, NaN where there is none, and the unit that their type has."""
    if str(column.type).startswith("decimal"):
        column = column.cast("double")
    if str(column.type).startswith("time") and not str(column.type).startswith("timestamp"):
        return from_the_first_s(column.cast("time64[ns]").cast("int64").to_numpy().astype(float) * _NS), "s"
    values = column.to_numpy()
    if values.dtype.kind == "M":
        there = values[~np.isnat(values)]
        values = values - (there.min() if there.size else 0)
    if values.dtype.kind == "m":
        return np.where(np.isnat(values), np.nan, values.astype("timedelta64[ns]").astype(np.int64) * _NS), "s"
    return (values.astype(float), "") if values.dtype.kind in "biuf" else (None, "")


def _of_text(column: Any) -> tuple[np.ndarray | None, str]:
    """Texts that are all numbers or dates and times of day as `_numbers`; None in place of values for any other text."""
    cells = [None if cell is None else cell.strip() for cell in column.to_pylist()]
    filled = [cell for cell in cells if cell is not None and not is_missing(cell)]
    for read in (time_of_day_s, _number):
        if filled and all(read(cell) is not None for cell in filled):
            found = [None if cell is None or is_missing(cell) else read(cell) for cell in cells]
            values = np.array([np.nan if value is None else value for value in found])
            return (from_the_first_s(values.tolist()), "s") if read is time_of_day_s else (values, "")
    return None, ""


def _number(cell: str) -> float | None:
    return number(cell, ".")
