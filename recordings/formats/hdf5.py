"""HDF5, as MATLAB's version 7.3 and many programs write it, by way of the optional package h5py."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from recordings.formats.clocks import with_clocks
from recordings.formats.matlab_objects import what
from recordings.formats.named_columns import named_columns
from recordings.formats.nested import Unreadable, flat, texts_of
from recordings.formats.optional import package
from recordings.layout import TextLayout
from recordings.signals import Contents
from records.errors import BadInput

UNIT_ATTRIBUTES = ("units", "unit", "Units", "Unit")  # netCDF's and NeXus' first


def read(path: Path, asked: TextLayout) -> Contents:
    """All datasets of numbers under their paths; raises BadInput for a file that is missing, damaged or no HDF5."""
    units: dict[str, str] = {}
    found = flat(content(path, units))
    signals = {name: replace(signal, unit=units.get(name, "")) for name, signal in found.signals.items()}
    named, told = named_columns(found)
    return Contents(with_clocks({**signals, **named}), found.texts, told, unread=found.unread, singles=found.singles)


def content(path: Path, units: dict[str, str] | None = None) -> dict[str, Any]:
    """The groups as dictionaries, MATLAB's arrays in its own order of rows and columns; `units` takes what the file states, by path.

    Raises BadInput, also where h5py is missing.
    """
    h5py = package("h5py", "hdf5", path)
    try:
        with h5py.File(path, "r") as file:
            if units is not None:
                file.visititems(lambda name, node: units.update(_unit(name, node)))
            return {name: _value(file[name], file) for name in file if not name.startswith("#")}
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, RecursionError) as error:
        if not path.is_file():
            raise BadInput("HDF5 file", str(path), "no such file", "a readable file", "check the path") from error
        raise BadInput("HDF5 file", str(path), f"no whole HDF5 ({error})", "an HDF5 file", "save it again") from error


def _unit(name: str, node: Any) -> dict[str, str]:
    """The unit that a dataset's attribute states, by its path; nothing where none does."""
    stated = next((node.attrs[word] for word in UNIT_ATTRIBUTES if word in node.attrs), None)
    text = stated.decode(errors="replace") if isinstance(stated, bytes) else stated
    return {name.replace("/", "."): text.strip()} if isinstance(text, str) else {}


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
        return Unreadable(what(kind))
    if node.attrs.get("MATLAB_empty"):
        return np.zeros(0)
    if node.dtype.kind == "O" and node.dtype.metadata and "ref" in node.dtype.metadata:
        return [_value(file[reference], file) for reference in np.ravel(node[()].T) if reference]
    if kind == "char":
        rows = ["".join(map(chr, row)) for row in np.atleast_2d(node[()].T)]
        return rows if len(rows) > 1 else "".join(rows)
    if node.dtype.kind == "S" or (node.dtype.metadata or {}).get("vlen") in (str, bytes):
        return texts_of(np.asarray(node.asstr(errors="replace")[()]))
    if node.dtype.names:
        return {name: np.asarray(node[name]) for name in node.dtype.names}
    return np.asarray(node[()]).T if kind else np.asarray(node[()])
