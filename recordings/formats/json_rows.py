"""JSON files: an object a line (.jsonl, .ndjson), a list of objects, or an object of lists (.json)."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from recordings.formats.clocks import with_clocks
from recordings.formats.nested import flat
from recordings.formats.text.cells import from_the_first_s, number, time_of_day_s
from recordings.formats.text.decoding import decoded
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal, counted
from records.errors import BadInput

MOST_TEXT = (
    0.5  # of an entry's values that are texts and no numbers: beyond it the entry is a text, as in a table of text
)


def read(path: Path, asked: TextLayout) -> Contents:
    """The numbers of all objects under their paths, NaN where an object lacks one; arrays of an object of lists as they are.

    Raises BadInput for a file that is missing and for no JSON, with the line.
    """
    text, told = decoded(path)
    content, found = _content(text, str(path))
    rows = _samples(content)
    if rows is None:
        arrays = flat(_arrays(content if isinstance(content, Mapping) else {"rows": content}))
        return Contents(with_clocks(arrays.signals), arrays.texts, told, arrays.unread, singles=arrays.singles)
    signals, unread = _signals(rows)
    return Contents(with_clocks(signals), found=(*told, *found), unread=unread)


def _content(text: str, where: str) -> tuple[Any, tuple[str, ...]]:
    """What the text holds, the values of its lines where it is not one value, and what is to be said of them."""
    try:
        return json.loads(text), ()
    except ValueError:
        return _lines(text, where)
    except RecursionError:
        got, expected = "lists within lists too deep to be read", "a list of objects, or an object a line"
        raise BadInput("JSON", where, got, expected, "export it again") from None


def _samples(content: Any) -> Sequence[Mapping[str, Any]] | None:
    """The first list of objects, the outer ones before the inner; None without one."""
    return next((value for value in (content, *_lists(content)) if _are_objects(value)), None)


def _lines(text: str, where: str) -> tuple[list[Any], tuple[str, ...]]:
    """The values of a file of one a line; a last line that was cut short is left out, and that is said."""
    lines = [(place, line) for place, line in enumerate(text.splitlines(), start=1) if line.strip(" \t,\0")]
    values: list[Any] = []
    for place, line in lines:
        try:
            values.append(json.loads(line.strip(" \t,\0")))
        except ValueError as error:
            if values and place == lines[-1][0]:
                return values, (f"line {place}, the last, is cut short and left out",)
            got = f"{line.strip()[:60]!r} ({error})"
            remedy = "export it again, an object a line, or give a table of text its own ending"
            raise BadInput("JSON file", f"{where}, line {place}", got, "JSON", remedy) from error
    if not values:
        raise BadInput("JSON file", where, "an empty file", "an object for each sample", "record or export it again")
    return values, (f"{counted(len(values), 'lines')} of JSON",)


def _lists(content: Any) -> Iterator[Any]:
    """The lists in an object, the outer ones first."""
    inner = list(content.values()) if isinstance(content, Mapping) else []
    yield from (value for value in inner if isinstance(value, list))
    for value in inner:
        yield from _lists(value)


def _are_objects(rows: Any) -> bool:
    """Whether a list is one of samples: objects, most of all."""
    return isinstance(rows, list) and len(rows) > 1 and all(isinstance(row, Mapping) for row in rows)


def _arrays(value: Any) -> Any:
    """Lists of numbers as arrays, null as NaN; all else as it is."""
    if isinstance(value, Mapping):
        return {name: _arrays(inner) for name, inner in value.items() if inner is not None}
    if not isinstance(value, list):
        return value
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        return [_arrays(inner) for inner in value]


def _signals(rows: Sequence[Mapping[str, Any]]) -> tuple[dict[str, Signal], dict[str, str]]:
    """The entries of all objects by path, and of each that is none of numbers what it is."""
    entries: dict[str, dict[int, Any]] = {}
    for row, content in enumerate(rows):
        for path, value in _leaves(content, ""):
            entries.setdefault(path, {})[row] = value
    found = {path: _signal(values, len(rows)) for path, values in entries.items()}
    signals = {path: signal for path, signal in found.items() if isinstance(signal, Signal)}
    return signals, {path: told for path, told in found.items() if isinstance(told, str)}


def _leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """What is neither an object nor a list, by path: a field behind a point, an entry of several in square brackets, from 0."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _leaves(inner, f"{path}.{name}" if path else str(name))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _leaves(inner, f"{path}[{index}]")
    elif value is not None:
        yield path, value


def _signal(values: Mapping[int, Any], length: int) -> Signal | str:
    """An entry of the objects as a signal; where it is text, what stands there first."""
    times = {row: time_of_day_s(value) if isinstance(value, str) else None for row, value in values.items()}
    dated = all(time is not None for time in times.values())
    numbers = times if dated else {row: _number(value) for row, value in values.items()}
    odd = {row: f"object {row + 1}: {str(values[row])[:30]!r}" for row, found in numbers.items() if found is None}
    if len(odd) > MOST_TEXT * len(values):
        return f"text, as {next(iter(odd.values()))}"
    column = np.full(length, np.nan)
    for row, found in numbers.items():
        column[row] = np.nan if found is None else found
    if dated:
        return Signal(from_the_first_s(list(column)), "s", instants=True)
    return Signal(column, faults=odd)


def _number(value: Any) -> float | None:
    return number(value.strip(), ".") if isinstance(value, str) else float(value)
