"""What a serial monitor and printf leave around numbers: a stamp in front of a line, `12:00:01.25 -> `, a name in front of each."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

from recordings.formats.text.lines import Line

MOST = 0.9  # of the lines must be written so: the first may be cut, and a program greets before it logs
FEWEST_PAIRS = 2  # of name and number in a line: one may stand in any sentence
SAMPLE_LINES = 400  # of which most must be: as for the layout of a table
TIME = "time"  # the heading of stamps
_STAMP = r"(?:[\d./-]{8,10}[ T])?\d{1,2}:\d\d:\d\d(?:[.,:]\d+)?|\d+(?:\.\d+)?"
_STAMPED = re.compile(rf"(?:\[(?P<within>{_STAMP})\]\s*(?:->|:)?|(?P<before>{_STAMP})\s*->)\s*(?P<rest>\S.*)")
_PAIR = re.compile(
    r"(?<![\w.])(?P<name>[A-Za-z_][\w./\[\]]*)\s*[:=]\s*(?P<value>[+-]?(?:\d|\.\d|nan|inf)[^\s,;|]*)", re.I
)


def as_table(lines: Sequence[Line]) -> tuple[list[Line], tuple[str, ...]]:
    """The lines as those of a table, where most of them are written so, and what is to be said of it; else as they are."""
    plain, stamped = _without_stamps(lines)
    table, named = _without_names(plain)
    return table, (*stamped, *named)


def _are_most(lines: Sequence[Line], is_so: Callable[[str], bool]) -> bool:
    """Whether most of the first lines are written so."""
    sample = lines[:SAMPLE_LINES]
    return bool(sample) and sum(is_so(line.text) for line in sample) >= MOST * len(sample)


def _without_stamps(lines: Sequence[Line]) -> tuple[list[Line], tuple[str, ...]]:
    """A stamp in front of a line as its first cell, by the separator of the others; over names it is called a time."""
    if not _are_most(lines, lambda text: _STAMPED.fullmatch(text.strip()) is not None):
        return list(lines), ()
    found = [(line, _STAMPED.fullmatch(line.text.strip())) for line in lines]
    return [line if match is None else replace(line, text=_with_cell(match)) for line, match in found], (
        "a stamp in front of each line",
    )


def _with_cell(match: re.Match[str]) -> str:
    rest = match["rest"]
    sign = next((sign for sign in ";\t,|" if sign in rest), " ")
    stamp = (match["within"] or match["before"]).replace(" ", "T")
    return f"{TIME if re.match(r'[A-Za-z_]', rest) and not _PAIR.match(rest) else stamp}{sign}{rest}"


def _without_names(lines: Sequence[Line]) -> tuple[list[Line], tuple[str, ...]]:
    """Numbers with a name in front of each as columns of these names; a line that lacks one has an empty cell for it."""
    if not _are_most(lines, lambda text: len(_pairs(text)[1]) >= FEWEST_PAIRS):
        return list(lines), ()
    pairs = [_pairs(line.text) for line in lines]
    names = list(dict.fromkeys(name for _, own in pairs for name in own))
    stamped = sum(bool(stamp) for stamp, _ in pairs) >= MOST * len(lines)
    rows = [
        replace(line, text="\t".join([*([stamp] if stamped else []), *(own.get(name, "") for name in names)]))
        for line, (stamp, own) in zip(lines, pairs, strict=True)
        if own
    ]
    heading = Line(rows[0].number, "\t".join([*([TIME] if stamped else []), *names]))
    return [heading, *rows], (f"a name in front of each number: {', '.join(names)}"[:200],)


def _pairs(text: str) -> tuple[str, dict[str, str]]:
    """The stamp in front of a line, if any, and its numbers by name; none of a line that holds other numbers too."""
    first = _PAIR.search(text)
    front = text[: first.start()].strip(" \t,;|") if first else ""
    stamp = front if re.fullmatch(_STAMP, front) else ""
    others = _PAIR.sub("", text[len(stamp) :])
    return stamp, {} if re.search(r"\d", others) else dict(_PAIR.findall(text))
