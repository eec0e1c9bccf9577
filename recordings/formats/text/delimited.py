"""Tables of text (.csv, .tsv, .txt): how they are laid out is found by itself, and said."""

import io
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from recordings.formats.clocks import with_clocks, with_clocks_in_front
from recordings.formats.text.above import is_comment
from recordings.formats.text.body import without_cut_cell, without_headers, without_messages, without_text_below
from recordings.formats.text.cells import (
    from_the_first_s,
    is_missing,
    number,
    number_and_unit,
    time_of_day_s,
)
from recordings.formats.text.decoding import decoded
from recordings.formats.text.headings import name_and_unit
from recordings.formats.text.layout import Layout, find_layout
from recordings.formats.text.lines import Line
from recordings.formats.text.long_form import as_wide
from recordings.formats.text.monitor import OF_NAMED, as_table
from recordings.formats.text.others import demand_table
from recordings.formats.text.splitting import SEPARATORS, split
from recordings.formats.text.thousands import ungrouped
from recordings.formats.text.totals import without_totals
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal, counted
from records.errors import BadInput

Array = NDArray[np.float64]

OVERLOAD = 9.9e37  # beyond the range or no number, as instruments write it: SCPI-99, volume 1, 7.2.1.4 and 7.2.1.5
LONGEST_RECORD = 64  # lines: a quote that is open for longer was never to be closed
ACROSS = 10  # times as many columns as rows: signals that lie in rows
MOST_TEXT = (
    0.5  # of a column's filled cells that are no numbers: beyond it the column is a text, not a signal with faults
)


def read(path: Path, asked: TextLayout) -> Contents:
    """The columns of a table as signals; a row that is short, or a cell that is no number, is a fault of its row.

    Raises BadInput for a file that is missing, no text, text of another kind, or holds no row of numbers.
    """
    text, found = decoded(path)
    demand_table(text, str(path))
    contents = of_text(text, asked, str(path))
    return replace(contents, texts=_sidecar(path), found=(*found, *contents.found))


def of_text(text: str, asked: TextLayout, where: str) -> Contents:
    """The same of a text that is there already; `where` names its file. Raises BadInput where it holds no row of numbers."""
    lines, comments, said = _lines(text, asked.skip)
    if said and asked.separator is None:
        asked = replace(asked, separator=said)
    lines, monitored = as_table(lines)
    layout = find_layout(lines, comments, asked, where)
    wide = as_wide(lines, layout)
    if wide is not None:
        lines, found_too = wide[0], (*layout.found, *wide[1])
        layout = replace(find_layout(lines, [], TextLayout("tab", layout.decimal), where), found=found_too)
    lines = ungrouped(lines, layout.separator, layout.decimal) if layout.grouped else lines
    rows, passed_over = without_messages(*without_headers(lines, layout), layout)
    body, left_out = without_text_below(rows, passed_over, layout)
    if not text.endswith(("\n", "\r")):
        body, left_out = without_cut_cell(body, left_out, layout)
    _check_upright(body, layout, where)
    of_cells = (
        2 if any(note.startswith(OF_NAMED) for note in monitored) else 0
    )  # their separator and heading: none are in such a file
    told = (*monitored, *layout.found[of_cells:], *_comments(comments), *left_out)
    signals, unread = _signals(body, layout)
    signals, totals = without_totals(signals)
    singles = {name: Signal(np.asarray(value)) for name, value in layout.singles.items()}
    signals = with_clocks(with_clocks_in_front(signals))
    return Contents(signals, found=(*told, *totals), unread=unread, singles=singles)


def _check_upright(body: Sequence[Line], layout: Layout, where: str) -> None:
    """Refuses signals that lie in rows, a sample a column, as a program prints its arrays; raises BadInput."""
    width = len(layout.headings)
    if layout.headings == tuple(f"c{place}" for place in range(1, width + 1)) and ACROSS * len(body) <= width:
        got = f"{counted(len(body), 'rows')} of {width} cells without a header, {layout.found[0]}"
        raise BadInput(
            "text file", where, got, "a row for each sample", "turn its rows into columns and export it again"
        )


def _sidecar(path: Path) -> dict[str, str]:
    """The text of NAME.toml beside NAME.csv, which says what flew where the table is a run log already."""
    try:
        return {"sidecar": path.with_suffix(".toml").read_text(encoding="utf-8")}
    except (OSError, UnicodeDecodeError):
        return {}


def _lines(text: str, skip: int) -> tuple[list[Line], list[Line], str | None]:
    """Lines behind those to skip, comments apart; and the separator that a spreadsheet's first line `sep=;` states."""
    numbered = [Line(index, line) for index, line in enumerate(re.split(r"\r\n|\r|\n", text), start=1) if index > skip]
    numbered = _with_whole_cells(numbered) if '"' in text else numbered
    stated = re.fullmatch(r'"?sep=(.)"?', numbered[0].text.strip()) if numbered else None
    filled = [line for line in numbered[1 if stated else 0 :] if line.text.strip()]
    comments = [line for line in filled if is_comment(line.text)]
    return [line for line in filled if not is_comment(line.text)], comments, stated[1] if stated else None


def _with_whole_cells(lines: Sequence[Line]) -> list[Line]:
    """The lines with those joined between which quotes are open, as a spreadsheet writes a cell of several lines."""
    found: list[Line] = []
    place = 0
    while place < len(lines):
        text, end = lines[place].text, place + 1
        while _is_open(text) and end < min(len(lines), place + LONGEST_RECORD):
            text, end = f"{text} {lines[end].text}", end + 1
        if _is_open(text):
            text, end = lines[place].text, place + 1
        found.append(replace(lines[place], text=text))
        place = end
    return found


def _is_open(text: str) -> bool:
    """Whether a cell that begins with a quote has no end yet; a quote within a cell stands for inches."""
    return text.count('"') % 2 == 1 and re.search(r'(?:^|[,;\t|])\s*"[^"]*$', text) is not None


def _comments(comments: Sequence[Line]) -> tuple[str, ...]:
    return (f"{counted(len(comments), 'lines')} of comment",) if comments else ()


def _signals(lines: Sequence[Line], layout: Layout) -> tuple[dict[str, Signal], dict[str, str]]:
    """The columns of numbers, and of each other what stands in it first."""
    units = [unit or name_and_unit(heading)[1] for unit, heading in zip(layout.units, layout.headings, strict=True)]
    numbers = _at_once(lines, layout)
    columns = _one_by_one(lines, layout) if numbers is None else [Signal(column) for column in numbers.T]
    signals: dict[str, Signal] = {}
    unread: dict[str, str] = {}
    for name, heading, unit, found in zip(_names(layout.headings), layout.headings, units, columns, strict=True):
        if isinstance(found, Signal):
            values = np.where(np.abs(found.values) >= OVERLOAD, np.nan, found.values)
            signals[name] = replace(found, values=values, unit=found.unit or unit, heading=heading)
        else:
            unread[name] = found
    return signals, unread


def _one_by_one(lines: Sequence[Line], layout: Layout) -> list[Signal | str]:
    """Each column cell by cell; a row of another width is a fault of all columns that it lacks, or of all where it is wider."""
    width = len(layout.headings)
    rows = [split(line.text, layout.separator) for line in lines]
    filled = [(line, row) for line, row in zip(lines, rows, strict=True) if not all(map(is_missing, row))]
    short = [f"line {line.number}: {len(row)} cells of {width}, {layout.found[0]}" for line, row in filled]
    whole = [[] if any(row[width:]) else row for _, row in filled]
    return [
        _column(
            [row[place] if place < len(row) else None for row in whole], [line for line, _ in filled], short, layout
        )
        for place in range(width)
    ]


def _names(headings: Sequence[str]) -> list[str]:
    """The names without units; of headings that are the same each gets its column before it, so that none hides another."""
    names = [name_and_unit(heading)[0] for heading in headings]
    counts = Counter(names)
    return [f"c{place}.{name}" if counts[name] > 1 else name for place, name in enumerate(names, start=1)]


def _at_once(lines: Sequence[Line], layout: Layout) -> Array | None:
    """All numbers at once, where every cell is a plain one."""
    body = "\n".join(line.text for line in lines)
    if '"' in body:
        return None
    body = body.replace(",", ".") if layout.decimal == "," else body
    try:
        rows = np.loadtxt(io.StringIO(body), delimiter=SEPARATORS[layout.separator], ndmin=2, comments=None)
    except ValueError:
        return None
    return rows if rows.shape == (len(lines), len(layout.headings)) else None


def _column(cells: Sequence[str | None], lines: Sequence[Line], short: Sequence[str], layout: Layout) -> Signal | str:
    """A column as a signal; where it is text, what stands there first."""
    times = [None if cell is None else time_of_day_s(cell) for cell in cells]
    if sum(time is not None for time in times) > 0.5 * len(cells):
        values = from_the_first_s([np.nan if time is None else time for time in times])
        faults = {
            row: _told(cells[row], lines[row], short[row], layout) for row, time in enumerate(times) if time is None
        }
        return Signal(values, "s", faults=faults, instants=True)
    values = np.array([np.nan if cell is None else _value(cell, layout.decimal) for cell in cells])
    nan = map(int, np.flatnonzero(np.isnan(values)))
    odd = [row for row in nan if (cell := cells[row]) is None or not is_missing(cell)]
    faults = {row: _told(cells[row], lines[row], short[row], layout) for row in odd}
    filled = sum(cell is not None and not is_missing(cell) for cell in cells)
    if filled and sum(cells[row] is not None for row in odd) > MOST_TEXT * filled:
        in_unit = _in_one_unit(cells, layout.decimal)
        return _with_unit(in_unit, lines, short, layout) if in_unit else f"text, as {next(iter(faults.values()))}"
    return Signal(values, faults=faults)


def _in_one_unit(cells: Sequence[str | None], decimal: str) -> tuple[list[str | None], str] | None:
    """Cells without the one unit that stands behind their numbers, and that unit; None where there are none or several."""
    found = [None if cell is None else number_and_unit(cell, decimal) for cell in cells]
    units = {pair[1] for pair in found if pair}
    if len(units) != 1:
        return None
    return [cell if pair is None else pair[0] for cell, pair in zip(cells, found, strict=True)], units.pop()


def _with_unit(
    in_unit: tuple[Sequence[str | None], str], lines: Sequence[Line], short: Sequence[str], layout: Layout
) -> Signal | str:
    column = _column(in_unit[0], lines, short, layout)
    return replace(column, unit=in_unit[1]) if isinstance(column, Signal) else column


def _told(cell: str | None, line: Line, short: str, layout: Layout) -> str:
    return short if cell is None else f"line {line.number}: {cell[:30]!r} among {layout.found[0]}"


def _value(cell: str, decimal: str) -> float:
    value = number(cell, decimal)
    return np.nan if value is None else value
