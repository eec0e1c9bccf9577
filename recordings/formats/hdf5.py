"""HDF5, as MATLAB's version 7.3 and many programs write it, by way of the optional package h5py."""

from pathlib import Path
from typing import Any

import numpy as np

from recordings.formats.clocks import with_clocks
from recordings.formats.matlab_objects import WHAT
from recordings.formats.nested import Unreadable, flat
from recordings.formats.optional import package
from recordings.layout import TextLayout
from recordings.signals import Contents
from records.errors import BadInput


def read(path: Path, asked: TextLayout) -> Contents:
    """All datasets of numbers under their paths; raises BadInput for a file that is missing, damaged or no HDF5."""
    found = flat(content(path))
    return Contents(with_clocks(found.signals), found.texts, unread=found.unread)


def content(path: Path) -> dict[str, Any]:
    """The groups as dictionaries, MATLAB's arrays in its own order of rows and columns; raises BadInput, also where h5py is missing."""
    h5py = package("h5py", "hdf5", path)
    try:
        with h5py.File(path, "r") as file:
            return {name: _value(file[name], file) for name in file if not name.startswith("#")}
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, RecursionError) as error:
        if not path.is_file():
            raise BadInput("HDF5 file", str(path), "no such file", "a readable file", "check the path") from error
        raise BadInput("HDF5 file", str(path), f"no whole HDF5 ({error})", "an HDF5 file", "save it again") from error


def _is_field_of_several(node: Any) -> bool:
    """Whether a field is one of an array of structures: references to each one's value, which is no cell array."""
    return not hasattr(node, "keys") and node.dtype.kind == "O" and not _kind(node) and node.size > 1


def _entries(fields: dict[str, Any]) -> Any:
    """The structures of an array one by one, out of the values of each field."""
    lengths = {len(values) if isinstance(values, list) else 0 for values in fields.values()}
    if len(lengths) != 1 or lengths == {0}:
        return fields
    return [{name: values[index] for name, values in fields.items()} for index in range(lengths.pop())]


def _kind(node: Any) -> str:
    """MATLAB's class of a dataset, empty where another program wrote it."""
    kind = node.attrs.get("MATLAB_class", b"")
    return kind if isinstance(kind, str) else bytes(kind).decode(errors="replace")


def _value(node: Any, file: Any) -> Any:
    if hasattr(node, "keys"):
        fields = {name: _value(node[name], file) for name in node}
        return _entries(fields) if all(_is_field_of_several(node[name]) for name in node) else fields
    kind = _kind(node)
    if "MATLAB_object_decode" in node.attrs or kind in ("function_handle", "timeseries"):
        return Unreadable(WHAT)
    if node.attrs.get("MATLAB_empty"):
        return np.zeros(0)
    if node.dtype.kind == "O" and node.dtype.metadata and "ref" in node.dtype.metadata:
        return [_value(file[reference], file) for reference in np.ravel(node[()].T) if reference]
    if kind == "char":
        return "".join(map(chr, np.ravel(node[()].T)))
    if node.dtype.kind in "OSU" and node.shape == ():
        return node.asstr()[()] if node.dtype.kind == "O" else node[()].decode(errors="replace")
    return np.asarray(node[()]).T if kind else np.asarray(node[()])
