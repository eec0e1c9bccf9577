"""MATLAB's .mat files: vectors, whole workspaces, structures of any depth, Simulink's scopes and matrices; version 7.3 through h5py."""

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from numpy import ndarray
from scipy.io import loadmat
from scipy.io.matlab import MatlabFunction, MatlabOpaque, MatReadError
from scipy.sparse import issparse

from recordings.formats import hdf5
from recordings.formats.clocks import is_time_name, with_clocks
from recordings.formats.matlab_objects import what, with_objects
from recordings.formats.named_columns import UNITS, named_columns
from recordings.formats.nested import Unreadable, flat, texts_of
from recordings.layout import TextLayout
from recordings.signals import Contents
from records.errors import BadInput

OCTAVE = b"# Created by Octave"  # in which it saves where it is not told otherwise
_LABELS = (
    "label",
    "Label",
    "Name",
    "name",
    "signalName",
    "SignalName",
)  # of a scope's signal, of a timeseries, and of dSPACE's

_PATH = re.compile(r"^[^\[(]*/(?=[A-Za-z_]\w*$)")  # Model Root/Plant/psi_deg, but not psi [m/s]


def read(path: Path, asked: TextLayout) -> Contents:
    """All arrays of numbers under their paths, all texts; raises BadInput for a file that is missing or no whole .mat file."""
    found = flat(with_objects(_content(path), path))
    texts = {name: text.strip() for name, text in found.texts.items()}
    signals = {
        name: replace(
            signal,
            unit=_beside(name, UNITS, texts) or _of_info(name, texts),
            heading=_label(name, texts, found.signals) or _of_series(name, found.signals),
        )
        for name, signal in found.signals.items()
    }
    named, told = named_columns(found)
    return Contents(with_clocks({**signals, **named}), texts, told, unread=found.unread, singles=found.singles)


def _label(name: str, texts: Mapping[str, str], signals: Mapping[str, object]) -> str:
    """The label of a value, without the blocks above it that dSPACE writes before; of a scope's signal that of its values alone, and not of
    what is said of them (`dimensions`)."""
    scope, _, field = name.rpartition(".")
    label = "" if field != "values" and f"{scope}.values" in signals else _beside(name, _LABELS, texts)
    return _PATH.sub("", label)


def _of_info(name: str, texts: Mapping[str, str]) -> str:
    """The unit in what a timeseries says of its data and times, where it was saved as a structure: `Data` beside `DataInfo`, in which it
    is a text, or Simulink's object that has its name."""
    places = (f"{name}Info.{word}{of}" for word in UNITS for of in ("", ".Name"))
    return next((texts[place] for place in places if place in texts), "")


def _of_series(name: str, signals: Mapping[str, object]) -> str:
    """The name of the timeseries whose data this is, empty for anything else: `psi_rad` of `psi_rad.Data` beside `psi_rad.Time`."""
    scope, _, field = name.rpartition(".")
    return scope.rpartition(".")[2] if field == "Data" and f"{scope}.Time" in signals else ""


def _beside(name: str, words: Sequence[str], texts: Mapping[str, str]) -> str:
    """The text that stands under one of `words` in the structure of a value, empty where there is none."""
    scope, _, field = name.rpartition(".")
    if not scope or is_time_name(field):
        return ""
    return next((texts[f"{scope}.{word}"] for word in words if f"{scope}.{word}" in texts), "")


def _content(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as stream, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of variables that it cannot read, which are told by name
            start = stream.read(len(OCTAVE))
            if start.startswith(b"\x89HDF\r\n\x1a\n"):
                return hdf5.content(path)
            if start == OCTAVE:
                raise BadInput(
                    "MATLAB file", str(path), "Octave's own text", "a .mat file", "save it in Octave with save -v7"
                )
            stream.seek(0)
            content = loadmat(stream, simplify_cells=True)
    except NotImplementedError:
        return hdf5.content(path)
    except (
        OSError,
        MatReadError,
        ValueError,
        TypeError,
        EOFError,
        KeyError,
        IndexError,
        MemoryError,
        ArithmeticError,
    ) as error:
        if isinstance(error, OSError) and error.strerror:  # what the system says; SciPy's own has none
            raise BadInput("MATLAB file", str(path), error.strerror, "a readable file", "check the path") from error
        raise BadInput(
            "MATLAB file", str(path), f"no whole .mat file ({error})", "a .mat file", "save it again with -v7"
        ) from error
    return {name: _readable(value) for name, value in content.items() if not name.startswith("__")}


def _readable(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _readable(inner) for name, inner in value.items()}
    if issparse(value):
        return value.toarray() if 1 in value.shape else Unreadable("a sparse matrix")
    if isinstance(value, ndarray) and value.dtype.kind == "U":
        return texts_of(value)  # a char matrix holds one in each row
    if isinstance(value, MatlabOpaque):
        return Unreadable(what(_class_of(value)))
    return Unreadable(what()) if isinstance(value, MatlabFunction) else value


def _class_of(value: Any) -> str:
    """MATLAB's class of an object that SciPy leaves closed."""
    kind = value.flat[0]["s2"] if value.size and "s2" in (value.dtype.names or ()) else b""
    return kind.decode(errors="replace") if isinstance(kind, bytes) else ""
