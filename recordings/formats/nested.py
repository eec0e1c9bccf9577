"""Structures within structures, as MATLAB workspaces and messages are, as signals under their paths."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from recordings.signals import Signal

FEWEST_ROWS = 10  # a handful of entries are as many motors, say
MOST_TEXTS = 256  # in one array, which may be the names of columns: more are a column of words


@dataclass(frozen=True)
class Flat:
    """Signals, texts and numbers of one value by path, and what is none of these."""

    signals: dict[str, Signal] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    unread: dict[str, str] = field(default_factory=dict)
    singles: dict[str, Signal] = field(default_factory=dict)


def flat(content: Mapping[str, Any]) -> Flat:
    """The content by path: a field behind a point, an entry of several in round brackets, counted from 1."""
    found = Flat()
    for name, value in _leaves(content, ""):
        if isinstance(value, str):
            found.texts[name] = value
            continue
        array = _real(np.asarray(value))
        if array.dtype.kind not in "biuf":
            found.unread[name] = (
                str(value)
                if isinstance(value, Unreadable)
                else ("complex numbers" if array.dtype.kind == "c" else "no numbers")
            )
        elif array.size > 1:
            found.signals[name] = Signal(np.squeeze(array).astype(float))
        elif array.size == 1:
            found.singles[name] = Signal(np.squeeze(array).astype(float))
        else:
            found.unread[name] = "empty"
    return found


def _real(array: np.ndarray) -> np.ndarray:
    """Complex numbers whose imaginary part is nothing as the real ones that they are; anything else as it is."""
    return array.real if array.dtype.kind == "c" and not array.imag.any() else array


@dataclass(frozen=True)
class Unreadable:
    """Something that a reader cannot give as numbers; `told` says what it is."""

    told: str

    def __str__(self) -> str:
        return self.told


def texts_of(array: np.ndarray) -> str | list[str] | Unreadable:
    """An array of texts as nested content has it: one as itself, as many as may be names one by one, a column of words as such."""
    if array.size > MOST_TEXTS:
        return Unreadable("words")
    return str(array) if array.ndim == 0 else [str(text) for text in array.flat]


def _leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _leaves(inner, f"{path}.{name}" if path else name)
    elif isinstance(value, Sequence) and not isinstance(value, str | bytes):
        if columns := _columns(value):
            yield from _leaves(columns, path)
            return
        for index, inner in enumerate(value, start=1):
            yield from _leaves(inner, f"{path}({index})")
    elif isinstance(value, np.ndarray) and value.dtype == object:
        yield from _leaves(list(value.flat), path)
    else:
        yield path, value


def _columns(entries: Sequence[Any]) -> dict[str, Any]:
    """Entries that are the rows of a log, `log(k).psi` one number each or a word, as its columns; empty for anything else."""
    if len(entries) < FEWEST_ROWS or not all(isinstance(entry, Mapping) for entry in entries):
        return {}
    fields = list(entries[0])
    if any(list(entry) != fields for entry in entries):
        return {}
    columns: dict[str, Any] = {}
    for name in fields:
        column = [entry[name] for entry in entries]
        if all(isinstance(value, str) for value in column):
            columns[name] = Unreadable("words")
        elif all(_is_number(value) for value in column):
            columns[name] = np.array([np.asarray(value, float).item() for value in column])
        else:
            return {}
    return columns


def _is_number(value: Any) -> bool:
    if isinstance(value, str | bytes | Mapping):
        return False
    array = np.asarray(value)
    return array.size == 1 and array.dtype.kind in "biuf"
