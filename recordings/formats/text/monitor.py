"""What a serial monitor and printf leave around numbers: a stamp in front of a line, `12:00:01.25 -> `, a name in front of each."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

from recordings.formats.text.lines import Line

MOST = 0.9  # of the lines must be written so: the first may be cut, and a program greets before it logs
FEWEST_PAIRS = 2  # of name and number in a line: one may stand in any sentence
SAMPLE_LINES = 400  # of which most must be: as for the layout of a table
OF_NAMED = (
    "a name in front of each number",
    "a signal a line",
)  # begin what is said of lines that have neither cells nor a heading
TIME = "time"  # the heading of stamps
_STAMP = r"(?:[\d./-]{8,10}[ T])?\d{1,2}:\d\d:\d\d(?:[.,:]\d+)?|\d+(?:\.\d+)?"
_STAMPED = re.compile(
    rf"(?:\[\s*(?P<within>{_STAMP})\]\s*(?:->|:)?|(?P<before>{_STAMP})\s*->|[EWIDV] \((?P<idf_ms>\d+)\) [\w.-]+:)\s*(?P<rest>\S.*)"
)  # the last as ESP-IDF logs: level, milliseconds since the start, whose line it is
_PAIR = re.compile(
    r"(?<![\w.])(?P<name>[A-Za-z_][\w./\[\]]*)\s*[:=]\s*(?P<value>[+-]?(?:\d|\.\d|nan|inf)[^\s,;|]*)", re.I
)
_BRACKETED = re.compile(r"[\[({]+(?P<list>[^\[\](){}]*\d[^\[\](){}]*)[\])}]+[,;]?|(?P<row>[^;]*\d[^;\d]?);")
_PLOTTED = re.compile(
    r">(?P<name>[^:;|>]+):(?:(?P<time>\d+(?:\.\d+)?):)?(?P<value>[+-]?[\d.]+(?:[eE][+-]?\d+)?)(?:§[^|]*)?(?:\|\w*)?"
)


def as_table(lines: Sequence[Line]) -> tuple[list[Line], tuple[str, ...]]:
    """The lines as those of a table, where most of them are written so, and what is to be said of it; else as they are."""
    plot = _as_plot(lines)
    if plot is not None:
        return plot, (f"{OF_NAMED[1]}, as Teleplot takes it",)
    plain, stamped = _without_stamps(_without_brackets(lines))
    table, named = _without_names(plain)
    return table, (*stamped, *named)


def _are_most(lines: Sequence[Line], is_so: Callable[[str], bool]) -> bool:
    """Whether most of the first lines are written so."""
    sample = lines[:SAMPLE_LINES]
    return bool(sample) and sum(is_so(line.text) for line in sample) >= MOST * len(sample)


def _as_plot(lines: Sequence[Line]) -> list[Line] | None:
    """Lines `>name:value` as rows that begin with the first name, `>name:time_ms:value` as rows of time, name and value; None for others.

    Format: Teleplot, "Telemetry format"; of a line that sends several, parted by semicolons, and of texts nothing is read.
    """
    if not _are_most(lines, lambda text: _PLOTTED.fullmatch(text.strip()) is not None):
        return None
    found = [(line, match) for line in lines if (match := _PLOTTED.fullmatch(line.text.strip()))]
    if all(match["time"] for _, match in found):
        rows = [replace(line, text="\t".join(match.group("time", "name", "value"))) for line, match in found]
        return [replace(rows[0], text="time_ms\tname\tvalue"), *rows]
    names = list(dict.fromkeys(match["name"] for _, match in found))
    rows = [replace(found[0][0], text="\t".join(names))]
    values: dict[str, str] = {}
    for line, match in found:
        if match["name"] in values:
            rows.append(replace(line, text="\t".join(values.get(name, "") for name in names)))
            values = {}
        values[match["name"]] = match["value"]
    return [*rows, replace(found[-1][0], text="\t".join(values.get(name, "") for name in names))]


def _without_brackets(lines: Sequence[Line]) -> Sequence[Line]:
    """The rows without what a program that prints a list or a matrix writes around each: `[0.1, 5.0],` or `0.1 5.0;`."""
    if not _are_most(lines, lambda text: _BRACKETED.fullmatch(text.strip()) is not None):
        return lines
    found = [(line, _BRACKETED.fullmatch(line.text.strip())) for line in lines]
    return [replace(line, text=match["list"] or match["row"]) if match else line for line, match in found]


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
    ms = match["idf_ms"]
    stamp = f"{int(ms) / 1000.0:g}" if ms else (match["within"] or match["before"]).replace(" ", "T")
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
    return [heading, *rows], (f"{OF_NAMED[0]}: {', '.join(names)}"[:200],)


def _pairs(text: str) -> tuple[str, dict[str, str]]:
    """The stamp in front of a line, if any, and its numbers by name; none of a line that holds other numbers too."""
    first = _PAIR.search(text)
    front = text[: first.start()].strip(" \t,;|") if first else ""
    stamp = front if re.fullmatch(_STAMP, front) else ""
    others = _PAIR.sub("", text[len(stamp) :])
    return stamp, {} if re.search(r"\d", others) else dict(_PAIR.findall(text))
