"""A table in long form, a signal's name and its value in each row, as data bases and telemetry write it: made one of a column a signal."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from recordings.formats.clocks import is_time_name
from recordings.formats.text.cells import is_missing, is_number
from recordings.formats.text.headings import name_and_unit
from recordings.formats.text.layout import SAMPLE_LINES, Layout
from recordings.formats.text.lines import Line
from recordings.formats.text.splitting import split

COLUMNS = 3  # a time, a name, a value
MOST = 0.9  # of a column's cells are words where it is one of names
MOST_NAMES = 64  # of signals: more are serial numbers or remarks
CHANGES = 0.5  # of the rows: names of signals take turns, while a state's name stays for a while


def as_wide(lines: Sequence[Line], layout: Layout) -> tuple[list[Line], tuple[str, ...]] | None:
    """The rows with a column for each name, all others empty, under a heading; and what is to be said of it.

    None for a table of another form: it takes one column of names that take turns, one of values and one of times, and no other.
    """
    if len(layout.headings) != COLUMNS:
        return None
    split_up = ((line, split(line.text, layout.separator)) for line in lines[layout.first :])
    rows = [(line, cells) for line, cells in split_up if len(cells) >= COLUMNS]
    texts = [place for place in range(COLUMNS) if _are_texts([cells[place] for _, cells in rows], layout.decimal)]
    if len(texts) != 1:
        return None
    name = texts[0]
    time, value = _time_and_value([place for place in range(COLUMNS) if place != name], layout)
    names = _taking_turns([cells[name] for _, cells in rows])
    if not names:
        return None
    places = {word: place for place, word in enumerate(names, start=1)}
    wide = [Line(rows[0][0].number, "\t".join([layout.headings[time], *names]))]
    for line, cells in rows:
        own = [cells[time], *([""] * len(names))]
        own[places[cells[name]]] = cells[value]
        wide.append(replace(line, text="\t".join(own)))
    return wide, (f"a signal a row, by its name under {layout.headings[name]}: {', '.join(names)}"[:200],)


def _time_and_value(places: Sequence[int], layout: Layout) -> tuple[int, int]:
    """The column of a time's name before the other; as they stand where neither has one."""
    first, second = sorted(places, key=lambda place: not is_time_name(name_and_unit(layout.headings[place])[0]))
    return first, second


def _taking_turns(said: Sequence[str]) -> list[str]:
    """The names, in the order in which they come, that take turns; none where they do not."""
    names = list(dict.fromkeys(said))
    changes = sum(one != other for one, other in pairwise(said))
    return names if 2 <= len(names) <= MOST_NAMES and changes >= CHANGES * len(said) else []


def _are_texts(cells: Sequence[str], decimal: str) -> bool:
    filled = [cell for cell in cells[:SAMPLE_LINES] if not is_missing(cell)]
    return bool(filled) and sum(not is_number(cell, decimal) for cell in filled) > MOST * len(filled)
