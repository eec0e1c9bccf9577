"""NumPy's own files: arrays by their names (.npz), one array or one of records with named fields (.npy)."""

from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from recordings.formats.clocks import with_clocks
from recordings.formats.named_columns import named_columns
from recordings.formats.nested import flat, texts_of
from recordings.layout import TextLayout
from recordings.signals import Contents, Signal
from records.errors import BadInput

ALONE = "array"  # the name of the array of a file that holds but one


def read(path: Path, asked: TextLayout) -> Contents:
    """All arrays of numbers, fields of records behind a point, dates in seconds from the first; Python's objects are never loaded.

    Raises BadInput for a file that is missing, damaged or none of NumPy's.
    """
    try:
        with path.open("rb") as stream:
            arrays = _arrays(np.load(stream, allow_pickle=False))
    except (OSError, ValueError, EOFError, KeyError, SyntaxError, BadZipFile) as error:
        if isinstance(error, OSError) and error.strerror:
            raise BadInput("NumPy file", str(path), error.strerror, "a readable file", "check the path") from error
        got, remedy = f"no whole file of arrays ({error})"[:200], "save it again with numpy.savez"
        raise BadInput("NumPy file", str(path), got, "arrays of numbers", remedy) from error
    found = flat({name: _readable(array) for name, array in arrays.items()})
    dated = {name: array for name, array in arrays.items() if array.dtype.kind in "Mm"}
    signals = {**found.signals, **{name: Signal(_seconds(array), "s", instants=True) for name, array in dated.items()}}
    unread = {name: told for name, told in found.unread.items() if name not in dated}
    named, told = named_columns(found)
    return Contents(with_clocks({**signals, **named}), found.texts, told, unread=unread, singles=found.singles)


def _arrays(loaded: Any) -> dict[str, Any]:
    """The arrays by name; records as one array a field."""
    arrays = {name: loaded[name] for name in loaded.files} if hasattr(loaded, "files") else {ALONE: loaded}
    fields = {
        (field if name == ALONE else f"{name}.{field}"): array[field]
        for name, array in arrays.items()
        for field in array.dtype.names or ()
    }
    return {**{name: array for name, array in arrays.items() if not array.dtype.names}, **fields}


def _readable(array: Any) -> Any:
    return texts_of(array) if array.dtype.kind in "US" else array


def _seconds(array: Any) -> Any:
    """Dates or durations as seconds from the first; NaN where there is none."""
    there = array[~np.isnat(array)]
    since = array - there.min() if there.size else array - array
    return np.where(np.isnat(array), np.nan, since / np.timedelta64(1, "ns") * 1e-9)
