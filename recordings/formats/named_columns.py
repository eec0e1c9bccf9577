"""Matrices whose columns are named by an array of texts beside them: MATLAB's cell and char arrays, importdata's `colheaders`."""

import re
from collections.abc import Iterator, Mapping

from recordings.formats.nested import FEWEST_ROWS, Flat
from recordings.formats.text.headings import name_and_unit
from recordings.signals import Array, Signal, listed

UNITS = ("unit", "units", "Unit", "Units")

Words = tuple[str, ...]


def named_columns(found: Flat) -> tuple[dict[str, Signal], tuple[str, ...]]:
    """The columns, or rows, of each matrix by their names, `data.psi_rad`, and what is said of it.

    Names are taken where the matrix and one array of as many different texts lie in one structure, and neither fits another one there.
    """
    arrays = {path: words for path, words in _arrays_of_texts(found).items() if _last(path) not in UNITS}
    units = {path: words for path, words in _arrays_of_texts(found).items() if _last(path) in UNITS}
    signals: dict[str, Signal] = {}
    told = []
    for matrix, names in _pairs(found.signals, arrays):
        vectors = _vectors(found.signals[matrix].values, len(arrays[names]))
        stated = [own for path, own in units.items() if _around(path) == _around(matrix) and len(own) == len(vectors)]
        beside = stated[0] if len(stated) == 1 else ("",) * len(vectors)
        own: dict[str, Signal] = {}
        for vector, heading, unit in zip(vectors, arrays[names], beside, strict=True):
            name, written = name_and_unit(heading)
            own[f"{matrix}.{name}"] = Signal(vector, unit or written, heading=heading)
        if len(own) == len(vectors):  # a value in two units is two columns of one name
            signals |= own
            told.append(f"{matrix} has the columns that {names} names: {listed(arrays[names])}")
    return signals, tuple(told)


def _pairs(signals: Mapping[str, Signal], arrays: Mapping[str, Words]) -> Iterator[tuple[str, str]]:
    """Each matrix with the array of texts that alone fits it, and fits it alone."""
    fitting = {
        matrix: {
            arrays[path]: path for path in arrays if _around(path) == _around(matrix) and _fit(signal, arrays[path])
        }
        for matrix, signal in signals.items()
        if signal.values.ndim == 2
    }  # by what the texts are: importdata holds the same ones twice
    for matrix, texts in fitting.items():
        for words, path in texts.items():
            others = (other for other in fitting if _around(other) == _around(matrix) and words in fitting[other])
            if len(texts) == 1 and set(others) == {matrix}:
                yield matrix, path


def _fit(signal: Signal, words: Words) -> bool:
    """Whether texts are as many as a matrix is wide, and all different; what is no longer than wide is no recording."""
    least, most = sorted(signal.values.shape)
    return least == len(words) == len(set(words)) and most > max(least, FEWEST_ROWS) and all(words)


def _vectors(values: Array, width: int) -> Array:
    return values if values.shape[0] == width else values.T


def _arrays_of_texts(found: Flat) -> dict[str, Words]:
    """The texts of each array that holds nothing else, by its path: of `names(1)` and all that follow, `names`."""
    arrays: dict[str, list[str]] = {}
    for name, text in found.texts.items():
        match = re.fullmatch(r"(.+)\((\d+)\)", name)
        if match and len(arrays.setdefault(match[1], [])) == int(match[2]) - 1:
            arrays[match[1]].append(text.strip())
    others = (*found.signals, *found.singles, *found.unread)
    mixed = {match[1] for name in others if (match := re.match(r"(.+)\(\d+\)", name))}
    return {path: tuple(words) for path, words in arrays.items() if path not in mixed}


def _around(path: str) -> str:
    return path.rpartition(".")[0]


def _last(path: str) -> str:
    return path.rpartition(".")[2]
