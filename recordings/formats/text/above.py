"""What stands above the rows of a table: names, units, remarks of each column, a preamble."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from recordings.formats.text.cells import DECIMALS, is_missing, is_number, number
from recordings.formats.text.labview import units_and_numbers
from recordings.formats.text.lines import Line
from recordings.formats.text.splitting import SEPARATORS, split, trimmed
from recordings.units import known

HEADING_LINES = 8  # before the numbers, among which the header is: below it stand units and remarks, not more
COMMENTS = ("#", "%", "//")
UNIT_LABELS = frozenset(("unit", "units"))
# What a spreadsheet writes for a cell that it cannot compute, in any language: #DIV/0!, #¿NOMBRE?, #N/A, #NV; ### where it is too wide.
_ERROR_FIRST = re.compile(r"\s*(#[^\s,;|a-z]*([!?]|N/?[ADV])|#{2,}(?=[,;\t|]))(?P<others>[\s,;|].*|)")
_SIGNS = re.compile(r"[,;\t|]")
_LABELLED = re.compile(r"(?:(?P<label>[A-Z][A-Za-z ]*):(?P<text>.*))?")  # or an empty cell, above times
_KIND = re.compile(
    r"[fiu]\d{1,2}|float(32|64)?|double|real|lreal|u?s?d?int\d*|bool(ean)?"
)  # as INCA, NumPy and PLCs write it


@dataclass(frozen=True)
class Above:
    """What the lines above the rows say: headings and units by column, what is to be told, numbers of one value by name."""

    headings: tuple[str, ...]
    units: tuple[str, ...]
    told: tuple[str, ...]
    singles: Mapping[str, float] = field(default_factory=dict)


def headings_above(before: Sequence[Line], way: tuple[str, str], width: int, widest: int, counted: bool) -> Above:
    """Headings and units by column out of the lines before the numbers, and what is to be said of them.

    Rows have `width` cells, or `widest` with empty ones behind them; `counted` rows begin with their number, which may have no heading.
    """
    separator, decimal = way
    labelled = labels(before, separator)
    near = [line for line in before if line not in labelled][-HEADING_LINES:]
    candidates = [(line, _cells_of_heading(line.text, separator, width, widest, counted)) for line in near]
    wide = [(line, cells) for line, cells in candidates if cells is not None and not _names_nothing(cells)]
    if separator != "blanks":  # a sentence may have as many words as the rows have cells
        wide = [(line, cells) for line, cells in wide if _is_of(line.text, separator)] or wide
    if not wide:
        names = tuple(f"c{index}" for index in range(1, width + 1))
        unnamed = (f"no header: the columns are c1 to c{width}", *_passed_over(before, separator, width))
        return Above(names, ("",) * width, unnamed)
    line, cells = wide[-1]
    units, singles, of_units = [""] * width, dict[str, float](), None
    if len(wide) > 1 and _are_units(cells):
        units, of_units = _stripped(cells), line
        line, cells = wide[-2]
        singles = _above_nothing(line, of_units, way, width)
    elif len(wide) > 1 and _are_units(wide[-2][1]):
        units, of_units = _stripped(wide[-2][1]), wide[-2][0]
    stated_line = next((line for line, (label, _) in labelled.items() if label.lower() in UNIT_LABELS), None)
    if stated_line and not of_units:
        units, of_units = [*labelled[stated_line][1], *units][:width], stated_line
    bare = [cell[1:-1] for cell in cells] if all(re.fullmatch(r"'[^']+'", cell) for cell in cells) else cells
    names = tuple(cell or f"c{index}" for index, cell in enumerate(bare, start=1))
    told = [f"header in line {line.number}: {shown(line.text)}"]
    if of_units:
        told.append(f"units in line {of_units.number}: {shown(of_units.text)}")
    top = min(one.number for one in (line, of_units) if one)
    if before[0].number < top:
        told.append(f"lines before {top} are passed over")
    if labelled:
        told.append(f"remarks of {', '.join(dict.fromkeys(label for label, _ in labelled.values()))} below the names")
    told += [
        f"line {left.number} is passed over: {left.text[:60]!r}, {len(trimmed(split(left.text, separator)))} cells of {width}"
        for left in before
        if left.number > line.number and left is not of_units and left not in labelled and not is_comment(left.text)
    ]
    stated, numbers = units_and_numbers([split(one.text, separator) for one in before], names, decimal)
    if stated:
        told.append(f"units of LabVIEW's header: {', '.join(unit or '-' for unit in stated)}")
    return Above(names, stated or tuple(units), tuple(told), {**singles, **numbers})


def is_comment(text: str) -> bool:
    """Whether a line is a remark; one that begins with a spreadsheet's error is a row where all else are numbers or nothing."""
    if not text.lstrip().startswith(COMMENTS):
        return False
    row = _ERROR_FIRST.fullmatch(text)
    if row is None:
        return True
    others = _SIGNS.split(row["others"]) if _SIGNS.search(row["others"]) else row["others"].split()
    return not all(_is_no_name(cell.strip()) for cell in others)


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
    cells = len(trimmed(split(last.text, separator)))
    half = " (half of the rows' cells: the comma separates and is the decimal sign too, which nobody can tell apart)"
    hint = half if separator == "comma" and 2 * cells == width else ""
    return (f"line {last.number} and those before it are passed over: {last.text[:60]!r}, {cells} cells{hint}",)


def shown(text: str, most: int = 160) -> str:
    """A line as it stands, cut at `most` characters."""
    return text.strip() if len(text.strip()) <= most else f"{text.strip()[: most - 3]}..."


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
    cells = trimmed(split(text, separator))
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
    """Units without the brackets around them; a first cell that says what the line holds, `Vertical Units`, is none."""
    bare = [cell.strip("[](){}") for cell in cells]
    return ["", *bare[1:]] if bare and not UNIT_LABELS.isdisjoint(bare[0].lower().split()) else bare


def labels(lines: Sequence[Line], separator: str) -> dict[Line, tuple[str, list[str]]]:
    """The lines that say one thing of each column, as Simulink's Data Inspector does, `Units: V`: the label and the texts behind it."""
    found = {}
    for line in lines:
        matches = [_LABELLED.fullmatch(cell) for cell in split(line.text, separator)]
        own = {match["label"] for match in matches if match and match["label"]}
        if len(own) == 1 and all(matches):
            found[line] = (own.pop(), [(match["text"] or "").strip() if match else "" for match in matches])
    return found


def _is_of(text: str, separator: str) -> bool:
    sign = SEPARATORS[separator]
    return sign is None or sign in text


def _are_units(cells: Sequence[str]) -> bool:
    """Whether a line below the names holds units: most of its cells are known ones or stand in brackets."""
    filled = [cell for cell in cells if not is_missing(cell)]
    units = [cell for cell in filled if known(cell.strip("[](){}")) or re.fullmatch(r"[\[({].*[\])}]", cell)]
    return len(filled) > 0 and 2 * len(units) > len(filled)
