"""The rows of a table without what stands between them and below."""

from collections.abc import Sequence

import numpy as np

from recordings.formats.text.cells import is_number, number
from recordings.formats.text.layout import SAMPLE_LINES, Layout
from recordings.formats.text.lines import Line
from recordings.formats.text.splitting import split
from recordings.signals import counted
from records.text.last_row import ROWS_BEFORE, may_be_cut


def without_headers(lines: Sequence[Line], layout: Layout) -> tuple[Sequence[Line], list[str]]:
    """The lines below the header without it where it stands again, as files laid behind one another have it; and that it does."""
    above = {line.text.strip() for line in lines[max(0, layout.first - 2) : layout.first]}
    below = lines[layout.first :]
    again = [line for line in below if line.text.strip() in above]
    if not again:
        return below, []
    told = (
        f"the header stands again in line {again[0].number}{' and later' if len(again) > 1 else ''}, and is passed over"
    )
    return [line for line in below if line.text.strip() not in above], [told]


def without_messages(lines: Sequence[Line], told: list[str], layout: Layout) -> tuple[Sequence[Line], list[str]]:
    """The lines without those that a program writes between its numbers; and the first of these.

    Such a line is shorter than a row and begins with text where rows do not; below the last row it is text below the numbers.
    """
    if not lines or _begins_with_text(lines[0], layout):
        return lines, told
    width = len(layout.headings)
    end = next((row for row in range(len(lines), 0, -1) if not _is_message(lines[row - 1], layout, width)), 0)
    messages = [line for line in lines[:end] if _is_message(line, layout, width)]
    if not messages:
        return lines, told
    first = f"first line {messages[0].number}: {messages[0].text[:60]!r}"
    said = f"{counted(len(messages), 'lines')} of text between the rows passed over, {first}"
    chosen = {line.number for line in messages}
    return [line for line in lines if line.number not in chosen], [*told, said]


def _is_message(line: Line, layout: Layout, width: int) -> bool:
    starts = line.text.lstrip()[:1]
    return (
        not (starts.isdigit() or starts in "+-.")
        and len(split(line.text.rstrip(), layout.separator)) < width
        and _begins_with_text(line, layout)
    )


def without_text_below(
    lines: Sequence[Line], told: list[str], layout: Layout
) -> tuple[Sequence[Line], tuple[str, ...]]:
    """The rows of numbers: a last row that was cut short, and text below the numbers, are left out and said; rows of nothing too."""
    end = len(lines)
    labelled = sum(_begins_with_text(line, layout) for line in lines[:SAMPLE_LINES]) > 0.5 * len(lines[:SAMPLE_LINES])
    while end > 1 and (
        not _values(lines[end - 1], layout)
        or _begins_with_text(lines[end - 1], layout) > labelled
        or _stands_apart(lines[end - 2 : end], layout)
    ):
        end -= 1
    if end < len(lines):
        told.append(f"text below the numbers is left out, from line {lines[end].number} on: {lines[end].text[:40]!r}")
    width, last = len(layout.headings), split(lines[end - 1].text, layout.separator)
    if end > 2 and len(last) < width:
        told.append(f"line {lines[end - 1].number}, the last, is cut short ({len(last)} cells of {width}) and left out")
        end -= 1
    return lines[:end], tuple(told)


def without_cut_cell(
    lines: Sequence[Line], told: tuple[str, ...], layout: Layout
) -> tuple[Sequence[Line], tuple[str, ...]]:
    """The rows of a file without a last line end, without the last where its last number may have lost digits: one that goes on from those
    above stays, as of these logs no bit of a firmware is asked, unless all above have more decimals."""
    *above, last = (split(line.text, layout.separator)[-1].strip() for line in lines[-1 - ROWS_BEFORE :])
    varies = len({len(cell.partition(layout.decimal)[2]) for cell in above}) > 1
    goes_on = varies and _goes_on([number(cell, layout.decimal) for cell in (*above, last)])
    if goes_on or not may_be_cut(last, above, layout.decimal):
        return lines, told
    said = (
        f"line {lines[-1].number}, the last, ends within a number, or may, as no line end is behind it, and is left out"
    )
    return lines[:-1], (*told, said)


def _goes_on(cells: Sequence[float | None]) -> bool:
    """Whether the last number lies no farther from the one above than these do from one another."""
    moves = np.abs(np.diff([np.nan if cell is None else cell for cell in cells]))
    return bool(moves[-1] <= np.max(moves[:-1], initial=0.0, where=np.isfinite(moves[:-1])))


def _stands_apart(lines: Sequence[Line], layout: Layout) -> bool:
    """Whether the second of two lines is a sum behind an empty line: without a first cell where the other has one."""
    first, last = (split(line.text, layout.separator)[0] for line in lines)
    return lines[1].number > lines[0].number + 1 and not last.strip() and bool(first.strip())


def _values(line: Line, layout: Layout) -> int:
    """How many cells of a line are numbers or times of day."""
    return sum(is_number(cell, layout.decimal) for cell in split(line.text, layout.separator))


def _begins_with_text(line: Line, layout: Layout) -> bool:
    """Whether the first cell of a line is neither a number nor says that there is none: `Max` of a summary."""
    cell = split(line.text, layout.separator)[0]
    return number(cell, layout.decimal) is None and not is_number(cell, layout.decimal)
