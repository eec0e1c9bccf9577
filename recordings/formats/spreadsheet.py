"""Workbooks of Excel (.xlsx, .xlsm, .xlsb, .xls) and OpenDocument (.ods), by way of the optional package python-calamine."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import Any

from recordings.formats.optional import package
from recordings.formats.text import delimited
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal, listed
from records.errors import BadInput

PACKAGE, EXTRA = "python_calamine", "excel"
_ROWS = TextLayout(separator="tab")  # as which a sheet is written to be read as a table of text is
_STARTS = (b"PK", b"\xd0\xcf\x11\xe0")  # of a workbook, zipped or of Excel 97


def read(path: Path, asked: TextLayout) -> Contents:
    """The columns of the sheet that holds numbers; of several sheets `SHEET.NAME` each. Values are those that the program last computed.

    A table of text under a workbook's ending, as many loggers write it, is read as such. Raises BadInput when python-calamine is not
    installed, for a file that is missing or no workbook, and for one without a row of numbers.
    """
    calamine = package(PACKAGE, EXTRA, path)
    try:
        with path.open("rb") as stream:
            start = stream.read(4)
    except OSError as error:
        raise BadInput(
            "workbook", str(path), error.strerror or str(error), "a readable file", "check the path"
        ) from error
    if start and not start.startswith(_STARTS):
        contents = delimited.read(path, TextLayout())
        return replace(contents, found=("a table of text under a workbook's ending", *contents.found))
    sheets = _sheets(path, calamine)
    tables: dict[str, Contents] = {}
    told: dict[str, str] = {}
    for name, rows in sheets.items():
        try:
            tables[name] = delimited.of_text(_text(rows), _ROWS, f"{path}, sheet {name}")
        except BadInput as error:
            told[name] = error.got
    if not tables:
        got = "; ".join(f"sheet {name}: {what}" for name, what in told.items())[:300] or "no sheet"
        raise BadInput("workbook", str(path), got, "a sheet with rows of numbers", "save values, not a diagram, in one")
    passed = (f"sheets without rows of numbers passed over: {listed(told)}",) if told else ()
    if len(tables) == 1:
        name, alone = next(iter(tables.items()))
        return replace(alone, found=(f"sheet {name}", *_found(alone), *passed))
    found = [f"sheet {name}: {told}" for name, table in tables.items() for told in _found(table)]
    signals = {f"{sheet}.{name}": signal for sheet, table in tables.items() for name, signal in _within(sheet, table)}
    unread = {f"{sheet}.{name}": what for sheet, table in tables.items() for name, what in table.unread.items()}
    return Contents(signals, found=(*found, *passed), unread=unread, groups={name: name for name in tables})


def _found(table: Contents) -> list[str]:
    """What was found of a sheet, without how its cells are separated, which nobody sees."""
    return [told for told in table.found if not told.startswith("cells separated")]


def _within(sheet: str, table: Contents) -> list[tuple[str, Signal]]:
    """The signals of one of several sheets, whose clocks bear its name too."""
    return [
        (name, replace(signal, clock=signal.clock and f"{sheet}.{signal.clock}"))
        for name, signal in table.signals.items()
    ]


def _sheets(path: Path, calamine: Any) -> dict[str, list[list[Any]]]:
    """The rows of cells of each sheet by its name, those of diagrams without any."""
    try:
        with path.open("rb") as stream:  # by what it holds: .xls is written over many a workbook
            workbook = calamine.CalamineWorkbook.from_filelike(stream)
            return {name: workbook.get_sheet_by_name(name).to_python() for name in workbook.sheet_names}
    except Exception as error:  # the package has a class for each kind of workbook
        got = f"no whole workbook ({error})"[:200]
        remedy = "save it again, without a password, as .xlsx or CSV"
        raise BadInput("workbook", str(path), got, "a workbook", remedy) from error


def _text(rows: Sequence[Sequence[Any]]) -> str:
    return "\n".join("\t".join(map(_cell, row)) for row in rows)


def _cell(value: Any) -> str:
    """A cell as a table of text has it: numbers with all digits, dates and spans of time as times of day."""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, datetime | time | date):
        return value.isoformat()
    if isinstance(value, timedelta):
        minutes, seconds = divmod(value.total_seconds(), 60.0)
        return f"{int(minutes) // 60}:{int(minutes) % 60:02d}:{seconds:09.6f}"
    return repr(value) if isinstance(value, float) else " ".join(str(value).replace('"', "").split())
