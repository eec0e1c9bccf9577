"""How a table of text is laid out: separator, decimal sign, where names, units and numbers stand; found by what makes most numbers."""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median, mode

from recordings.formats.text.cells import DECIMALS, is_grouped, is_missing, is_number, number
from recordings.formats.text.labview import units_and_numbers
from recordings.formats.text.lines import Line
from recordings.layout import TextLayout
from recordings.units import known
from records.errors import BadInput

SEPARATORS: dict[str, str | None] = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "blanks": None}
SAMPLE_LINES = 400  # by which the layout is told: enough to pass a preamble, few enough to be quick
FOLLOWING = 3  # rows of numbers in a row, where the table is: a preamble has one or two
HEADING_LINES = 8  # before the numbers, among which the header is: below it stand units and remarks, not more
COMMENTS = ("#", "%", "//")
_KIND = re.compile(
    r"[fiu]\d{1,2}|float(32|64)?|double|real|lreal|u?s?d?int\d*|bool(ean)?"
)  # as INCA, NumPy and PLCs write it


@dataclass(frozen=True)
class Layout:
    """A table's layout: the separator by its name, the width of a row, headings and units by column, the first row's place in the lines.

    `singles` are numbers of one value that stand above the rows, by name.
    """

    separator: str
    decimal: str
    headings: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    found: tuple[str, ...]
    singles: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class _Above:
    """What the lines above the rows say: headings and units by column, what is to be told, numbers of one value by name."""

    headings: tuple[str, ...]
    units: tuple[str, ...]
    told: tuple[str, ...]
    singles: Mapping[str, float] = field(default_factory=dict)


def split(text: str, separator: str) -> list[str]:
    """The stripped cells of a line; quotes hold what is between them together."""
    sign = SEPARATORS[separator]
    if '"' in text:
        text = re.sub(r"\s+", " ", text.strip()) if sign is None else text
        return [cell.strip() for cell in next(csv.reader([text], delimiter=sign or " ", skipinitialspace=True))]
    return [cell.strip() for cell in text.split(sign)]


def find_layout(lines: Sequence[Line], comments: Sequence[Line], asked: TextLayout, where: str) -> Layout:
    """The layout of the lines; a last comment before the numbers may hold the names. Raises BadInput where no row is of numbers."""
    sample = lines[:SAMPLE_LINES]
    separator, decimal, score = max(_scores(sample, asked), key=lambda entry: entry[2])  # of equals the first
    if not score:
        shown = repr(sample[0].text[:60]) if sample else "an empty file"
        tried = f"{shown}, and no row of numbers below it" if sample else shown
        remedy = "say --separator, --decimal and --skip, or export it as CSV"
        raise BadInput(
            "text file", f"{where}, line {sample[0].number if sample else 1}", tried, "rows of numbers", remedy
        )
    rows = [split(line.text, separator) for line in sample]
    counts = [sum(is_number(cell, decimal) for cell in row) for row in rows]
    least = max(1.0, 0.5 * median(count for count in counts if count))
    numbers = [row for row, count in zip(rows, counts, strict=True) if count >= least]
    filled = mode(len(_trimmed(row)) for row in numbers)
    widest = mode(map(len, numbers))
    fits = [len(row) >= filled and not any(row[widest:]) for row in rows]
    usual = median(map(_texts, numbers, [decimal] * len(numbers)))
    labelled = [_texts(row, decimal) > max(usual, count - 1) for row, count in zip(rows, counts, strict=True)]
    first = _first([c >= least and fit and not label for c, fit, label in zip(counts, fits, labelled, strict=True)])
    width = max([filled, *(cells for line in lines[first:] if (cells := _filled(line.text, separator)) <= widest)])
    before = [*(line for line in comments if line.number < sample[first].number), *sample[:first]]
    before = sorted(before, key=lambda line: line.number)
    above = _headings(before, (separator, decimal), width, widest, _are_counted(numbers))
    comma = " with decimal commas" if decimal == "," else ""
    grouped = next((cell for row in numbers for cell in row if is_grouped(cell, decimal)), None)
    apart = f" and thousands apart, as {grouped}" if grouped else ""
    found = (f"cells separated by {separator}{comma}{apart}", *above.told)
    return Layout(separator, decimal, above.headings, above.units, first, found, above.singles)


def _texts(row: Sequence[str], decimal: str) -> int:
    """How many cells of a row hold a text: as many as numbers are labels of these, as a head has them."""
    return sum(not is_missing(cell) and not is_number(cell, decimal) for cell in row)


def _first(are_numbers: Sequence[bool]) -> int:
    """The first row of numbers that others follow, as a line of a preamble may look like one; else the first of all."""
    firsts = [index for index, is_row in enumerate(are_numbers) if is_row]
    return next((index for index in firsts if all(are_numbers[index : index + FOLLOWING])), firsts[0])


def _scores(sample: Sequence[Line], asked: TextLayout) -> list[tuple[str, str, float]]:
    """For each way to read the sample how many numbers it makes, less where it leaves cells that are none."""
    quoted = any('"' in line.text for line in sample)
    ways = [
        (separator, decimal)
        for separator in ([_name(asked.separator)] if asked.separator else SEPARATORS)
        for decimal in ([asked.decimal] if asked.decimal else DECIMALS)
        if quoted or SEPARATORS[separator] != decimal
    ]
    return [
        (*way, sum(_worth(split(line.text, way[0]), way[1]) for line in sample)) for way in ways or [("comma", ".")]
    ]


def _worth(row: Sequence[str], decimal: str) -> float:
    filled = sum(not is_missing(cell) for cell in row)
    return sum(is_number(cell, decimal) for cell in row) ** 2 / filled if filled else 0.0


def _name(separator: str) -> str:
    """The name of a separator that a user gave as a sign or by its name; raises BadInput."""
    signs = {sign: name for name, sign in SEPARATORS.items() if sign} | {"\\t": "tab", " ": "blanks", "space": "blanks"}
    name = signs.get(separator, separator)
    if name not in SEPARATORS:
        known_names = ", ".join(f"{name} {sign!r}" if sign else name for name, sign in SEPARATORS.items())
        raise BadInput("separator", "--separator", repr(separator), f"one of {known_names}", "choose one of these")
    return name


def _filled(text: str, separator: str) -> int:
    """How many cells of a line there are up to its last filled one: a signal of few samples has none in most rows."""
    sign = SEPARATORS[separator]
    return len(text.split()) if sign is None else text.rstrip(f"{sign} \t").count(sign) + 1


def _trimmed(row: list[str]) -> list[str]:
    """A row without the empty cells behind its last separator."""
    while len(row) > 1 and not row[-1]:
        row = row[:-1]
    return row


def _headings(before: Sequence[Line], way: tuple[str, str], width: int, widest: int, counted: bool) -> _Above:
    """Headings and units by column out of the lines before the numbers, and what is to be said of them.

    Rows have `width` cells, or `widest` with empty ones behind them; `counted` rows begin with their number, which may have no heading.
    """
    separator, decimal = way
    near = before[-HEADING_LINES:]
    candidates = [(line, _cells_of_heading(line.text, separator, width, widest, counted)) for line in near]
    wide = [(line, cells) for line, cells in candidates if cells is not None and not _names_nothing(cells)]
    if not wide:
        names = tuple(f"c{index}" for index in range(1, width + 1))
        unnamed = (f"no header: the columns are c1 to c{width}", *_passed_over(before, separator, width))
        return _Above(names, ("",) * width, unnamed)
    line, cells = wide[-1]
    units, singles, of_units = [""] * width, dict[str, float](), None
    if len(wide) > 1 and _are_units(cells):
        units, of_units = _stripped(cells), line
        line, cells = wide[-2]
        singles = _above_nothing(line, of_units, way, width)
    elif len(wide) > 1 and _are_units(wide[-2][1]):
        units, of_units = _stripped(wide[-2][1]), wide[-2][0]
    names = tuple(cell or f"c{index}" for index, cell in enumerate(cells, start=1))
    told = [f"header in line {line.number}: {shown(line.text)}"]
    if of_units:
        told.append(f"units in line {of_units.number}: {shown(of_units.text)}")
    top = min(one.number for one in (line, of_units) if one)
    if before[0].number < top:
        told.append(f"lines before {top} are passed over")
    told += [
        f"line {left.number} is passed over: {left.text[:60]!r}, {len(_trimmed(split(left.text, separator)))} cells of {width}"
        for left in before
        if left.number > line.number and left is not of_units and not left.text.lstrip().startswith(COMMENTS)
    ]
    stated, numbers = units_and_numbers([split(one.text, separator) for one in before], names, decimal)
    if stated:
        told.append(f"units of LabVIEW's header: {', '.join(unit or '-' for unit in stated)}")
    return _Above(names, stated or tuple(units), tuple(told), {**singles, **numbers})


def _above_nothing(names: Line, units: Line, way: tuple[str, str], width: int) -> dict[str, float]:
    """The numbers of the line of units that stand beyond the rows' cells, each under its name, as an oscilloscope has its first time."""
    separator, decimal = way
    pairs = zip(split(names.text, separator)[width:], split(units.text, separator)[width:], strict=False)
    found = {name: number(cell, decimal) for name, cell in pairs if name and not is_missing(cell)}
    return {name: value for name, value in found.items() if value is not None}


def _passed_over(before: Sequence[Line], separator: str, width: int) -> tuple[str, ...]:
    """What stands before rows that have no header: one of half their cells tells of a comma for two things."""
    if not before:
        return ()
    last = before[-1]
    cells = len(_trimmed(split(last.text, separator)))
    half = " (half of the rows' cells: the comma separates and is the decimal sign too, which nobody can tell apart)"
    hint = half if separator == "comma" and 2 * cells == width else ""
    return (f"line {last.number} and those before it are passed over: {last.text[:60]!r}, {cells} cells{hint}",)


def shown(text: str, most: int = 160) -> str:
    """A line as it stands, cut at `most` characters."""
    return text.strip() if len(text.strip()) <= most else f"{text.strip()[: most - 3]}..."


def _are_counted(rows: Sequence[Sequence[str]]) -> bool:
    """Whether the rows begin with 0, 1, 2, ... or 1, 2, 3, ..., as R and pandas write them."""
    firsts = [row[0] for row in rows]
    return any(firsts == [str(number) for number in range(start, start + len(rows))] for start in (0, 1))


def _cells_of_heading(text: str, separator: str, width: int, widest: int, counted: bool) -> list[str] | None:
    """The cells of a line as wide as the rows, split as these or, as some loggers do, in another way; None for another line."""
    bare = text.lstrip("".join(COMMENTS) + " ") if text.startswith(COMMENTS) else text
    for way in (separator, *SEPARATORS):
        cells = [cell.rstrip(",;") if way == "blanks" else cell for cell in split(bare, way)]
        cells = cells[:width] if width < len(cells) <= widest or not any(cells[width:]) else cells
        cells = ["", *cells] if counted and len(cells) == width - 1 else cells
        if len(cells) == width and 2 * sum(map(bool, cells)) >= width:
            return cells
    return _wider_than_rows(bare, separator, width)


def _wider_than_rows(text: str, separator: str, width: int) -> list[str] | None:
    """The first cells of a heading that names more than the rows hold, a remark or a first time; None for another line."""
    cells = _trimmed(split(text, separator))
    named = len(cells) > width and separator != "blanks"
    return cells[:width] if named and not any(_is_no_name(cell) for cell in cells[:width]) else None


def _is_no_name(cell: str) -> bool:
    return is_missing(cell) or any(is_number(cell, decimal) for decimal in DECIMALS)


def _names_nothing(cells: Sequence[str]) -> bool:
    """Whether a line is no heading: it says what kind of number each column holds, is a rule, or has a number twice."""
    filled = [cell.lower() for cell in cells if cell]
    numbers = [cell for cell in filled if any(is_number(cell, decimal) for decimal in DECIMALS)]
    alike = len(filled) > 1 and (len(set(filled)) == 1 or all(map(_KIND.fullmatch, filled)))
    return alike or len(set(numbers)) < len(numbers)


def _stripped(cells: Sequence[str]) -> list[str]:
    """Units without the brackets around them."""
    return [cell.strip("[](){}") for cell in cells]


def _are_units(cells: Sequence[str]) -> bool:
    """Whether a line below the names holds units: most of its cells are known ones or stand in brackets."""
    filled = [cell for cell in cells if not is_missing(cell)]
    units = [cell for cell in filled if known(cell.strip("[](){}")) or re.fullmatch(r"[\[({].*[\])}]", cell)]
    return len(filled) > 0 and 2 * len(units) > len(filled)
