"""How a table of text is laid out: separator, decimal sign, where names, units and numbers stand; found by what makes most numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median, mode

from recordings.formats.text.above import headings_above
from recordings.formats.text.cells import DECIMALS, is_missing, is_number, may_be_grouped
from recordings.formats.text.lines import Line
from recordings.formats.text.splitting import SEPARATORS, filled_cells, name_of_separator, split, trimmed
from recordings.formats.text.thousands import are_thousands, doubtful, ungrouped
from recordings.layout import TextLayout
from records.errors import BadInput

SAMPLE_LINES = 400  # by which the layout is told: enough to pass a preamble, few enough to be quick
FOLLOWING = 3  # rows of numbers in a row, where the table is: a preamble has one or two
APART = 0.9  # of a number is one that takes thousands apart: enough to decide between two readings of as many numbers


@dataclass(frozen=True)
class Layout:
    """A table's layout: the separator by its name, the width of a row, headings and units by column, the first row's place in the lines.

    `singles` are numbers of one value that stand above the rows, by name; `grouped`: thousands stand apart.
    """

    separator: str
    decimal: str
    headings: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    found: tuple[str, ...]
    singles: Mapping[str, float] = field(default_factory=dict)
    grouped: bool = False


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
    if asked.decimal is None and are_thousands(rows):
        decimal = ","
    grouped = next((cell for row in rows for cell in row if may_be_grouped(cell, decimal)), None)
    if grouped:
        lines = ungrouped(lines, separator, decimal)
        sample = lines[:SAMPLE_LINES]
        rows = [split(line.text, separator) for line in sample]
    counts = [sum(is_number(cell, decimal) for cell in row) for row in rows]
    least = max(1.0, 0.5 * median(count for count in counts if count))
    numbers = [row for row, count in zip(rows, counts, strict=True) if count >= least]
    filled = mode(len(trimmed(row)) for row in numbers)
    widest = mode(map(len, numbers))
    fits = [len(row) >= filled and not any(row[widest:]) for row in rows]
    usual = median(map(_texts, numbers, [decimal] * len(numbers)))
    labelled = [_texts(row, decimal) > max(usual, count - 1) for row, count in zip(rows, counts, strict=True)]
    first = _first([c >= least and fit and not label for c, fit, label in zip(counts, fits, labelled, strict=True)])
    width = max([filled, *(cells for line in lines[first:] if (cells := filled_cells(line.text, separator)) <= widest)])
    before = [*(line for line in comments if line.number < sample[first].number), *sample[:first]]
    before = sorted(before, key=lambda line: line.number)
    above = headings_above(before, (separator, decimal), width, widest, _are_counted(numbers))
    comma = " with decimal commas" if decimal == "," else ""
    apart = f" and thousands apart, as {grouped}" if grouped else ""
    found = (f"cells separated by {separator}{comma}{apart}", *above.told, *doubtful(numbers))
    return Layout(separator, decimal, above.headings, above.units, first, found, above.singles, grouped is not None)


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
        for separator in ([name_of_separator(asked.separator)] if asked.separator else SEPARATORS)
        for decimal in ([asked.decimal] if asked.decimal else DECIMALS)
        if quoted or SEPARATORS[separator] != decimal
    ]
    return [
        (*way, sum(_worth(split(line.text, way[0]), way[1]) for line in sample)) for way in ways or [("comma", ".")]
    ]


def _worth(row: Sequence[str], decimal: str) -> float:
    filled = sum(not is_missing(cell) for cell in row)
    return sum(_likely(cell, decimal) for cell in row) ** 2 / filled if filled else 0.0


def _likely(cell: str, decimal: str) -> float:
    """How likely a cell is a number by a decimal sign: less where its thousands must stand apart, as `1.234` is one without."""
    return 1.0 if is_number(cell, decimal) else APART if may_be_grouped(cell, decimal) else 0.0


def _are_counted(rows: Sequence[Sequence[str]]) -> bool:
    """Whether the rows begin with 0, 1, 2, ... or 1, 2, 3, ..., as R and pandas write them."""
    firsts = [row[0] for row in rows]
    return any(firsts == [str(number) for number in range(start, start + len(rows))] for start in (0, 1))
