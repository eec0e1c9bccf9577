"""MATLAB's objects in a .mat file: timeseries, tables, timetables, data sets of Simulink, by way of the optional package mat-io."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from recordings.formats.nested import Unreadable
from recordings.formats.optional import is_installed

EXTRA = "matlab"
SERIES = "s.x.Time = x.Time; s.x.Data = x.Data"
LOGGED = "of each signal x = {}.get('x').Values; " + SERIES
TABLE = "s = table2struct(x, 'ToScalar', true)"
TIMETABLE = (
    "s = table2struct(timetable2table(x, 'ConvertRowTimes', false), 'ToScalar', true); "
    "s.Time = seconds(x.Properties.RowTimes - x.Properties.RowTimes(1))"
)
# What turns an object x of a class into a structure s of vectors, to be saved with save('log.mat', '-struct', 's').
AS_STRUCTURE = {
    "timeseries": SERIES,
    "table": TABLE,
    "timetable": TIMETABLE,
    "Simulink.SimulationData.Dataset": LOGGED.format("DATASET"),
    "Simulink.SimulationOutput": LOGGED.format("OUTPUT.logsout"),
}
UNITS_S = {
    "weeks": 604800.0, "days": 86400.0, "hours": 3600.0, "minutes": 60.0, "seconds": 1.0,
    "milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9,
}  # fmt: skip
NAMELESS = "(object)"
UNNAMED = "unnamed"  # MATLAB's name of a timeseries that was given none
DEEPEST = 12  # objects within objects; MATLAB's own are three deep, and one may hold itself


def what(kind: str = "") -> str:
    """What is said of an object of a class that cannot be read here, with what to type in MATLAB."""
    return f"a MATLAB object{f' of class {kind}' if kind else ''}: install mat-io, the extra {EXTRA}, or in MATLAB {_save(kind)}"


def _save(kind: str) -> str:
    known = AS_STRUCTURE.get(kind)
    ways = known or f"{SERIES} of a timeseries x, {TABLE} of a table"
    return f"{ways}; save('log.mat', '-struct', 's')"


def with_objects(content: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """The variables with what objects hold in place of those that could not be read; as they are where mat-io is not installed.

    SciPy does not know the names of objects in files up to version 7, so all that it lacks is taken.
    """
    known = {name: value for name, value in content.items() if not _holds_unreadable(value)}
    if len(known) == len(content) or not is_installed("matio"):
        return {NAMELESS if name == "None" else name: value for name, value in content.items()}
    from matio import load_from_mat

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of times that are rounded to nanoseconds
        try:
            read = load_from_mat(str(path))
        except Exception as error:  # a class of its own for each part of the format
            told = f"a MATLAB object that mat-io cannot read ({type(error).__name__}): in MATLAB {_save('')}"
            return {**known, **{name: Unreadable(told) for name in content if name not in known}}
    return {
        **known,
        **{name: _plain(value, 0) for name, value in read.items() if name not in known and name[:2] != "__"},
    }


def _holds_unreadable(value: Any) -> bool:
    if isinstance(value, Mapping):
        return any(map(_holds_unreadable, value.values()))
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return any(map(_holds_unreadable, value))
    if isinstance(value, np.ndarray) and value.dtype == object:
        return any(map(_holds_unreadable, value.flat))
    return isinstance(value, Unreadable)


def _plain(value: Any, depth: int) -> Any:
    """A value of mat-io as numbers, texts, and dictionaries and lists of them."""
    if depth > DEEPEST:
        return Unreadable("an object within too many others")
    if hasattr(value, "classname"):
        held = {name: _plain(inner, depth + 1) for name, inner in value.properties.items()}
        return _series(held) if "TimeInfo" in held else held
    if hasattr(value, "columns") and hasattr(value, "index"):
        return dict(_table(value))
    if isinstance(value, Mapping):
        return {str(name): _plain(inner, depth + 1) for name, inner in value.items()}
    array = np.asarray(value)
    if array.dtype.names:
        fields = [{name: _plain(entry[name], depth + 1) for name in array.dtype.names} for entry in array.flat]
        return fields[0] if len(fields) == 1 else fields
    if array.dtype == object:
        entries = [_plain(entry, depth + 1) for entry in array.flat]
        return entries[0] if len(entries) == 1 else entries
    if array.dtype.kind in "mM":
        return _seconds(array)
    return str(array.flat[0]) if array.dtype.kind in "SU" and array.size == 1 else array


def _series(held: Mapping[str, Any]) -> dict[str, Any]:
    """A timeseries as MATLAB shows it; times of rows at one rate are stored as their start, step and number."""
    about = held["TimeInfo"] if isinstance(held["TimeInfo"], Mapping) else {}
    stored: list[Any] = [held.get("Time_"), about.get("Time_"), held.get("Time")]
    times = next((t for t in stored if np.size(t) > 1), None)
    if times is None:
        start, step, length = (
            float(np.ravel(about.get(name, np.nan))[0]) for name in ("Start_", "Increment_", "Length")
        )
        if not np.isfinite([start, step, length]).all():
            return {"Data": held.get("Data_"), "Time": Unreadable("times that are stored as MATLAB alone knows")}
        times = start + step * np.arange(int(length))
    times = np.ravel(times) * UNITS_S.get(str(about.get("Units", "")), 1.0)
    data = np.asarray(held.get("Data_", held.get("Data")))
    told = held.get("DataInfo")
    unit = told.get("Units", "") if isinstance(told, Mapping) else ""
    unit = unit.get("Name", "") if isinstance(unit, Mapping) else unit  # Simulink's object
    name = held.get("Name", "")
    return {"Time": times, "Data": np.squeeze(data), "Name": "" if name == UNNAMED else name, "Units": unit}


def _table(frame: Any) -> Iterator[tuple[str, Any]]:
    """Columns of a table; of a timetable the times of its rows too."""
    if frame.index.dtype.kind in "mM":
        yield "Time", _seconds(frame.index.to_numpy())
    for name in frame.columns:
        values = frame[name].to_numpy()
        yield str(name), _seconds(values) if values.dtype.kind in "mM" else _plain(values, 0)


def _seconds(values: Any) -> Any:
    """Spans of time in seconds, dates in seconds since 1970."""
    spans = values - np.datetime64(0, "s") if values.dtype.kind == "M" else values
    return spans / np.timedelta64(1, "s")
