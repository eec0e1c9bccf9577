"""Flight tests as files: NAME.csv with every signal and NAME.toml that says what was flown and what for."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tomlkit
from numpy.typing import NDArray

from identification.envelope.flights.conditions import condition_of
from identification.envelope.flights.flight import CONTROLS, INPUTS, OUTPUTS, STATES, USES, Flight
from identification.envelope.flights.look import demand_sound
from identification.margins import MARGINS
from records.errors import BadInput
from records.files import write_atomic
from records.text import checks
from records.text.log_csv import read_rows, rows_text
from records.text.reading import read_toml

Array = NDArray[np.float64]

SCHEMA = "flight-test/1"
COLUMNS = ("t_s", *INPUTS, *STATES, *OUTPUTS)
_KEYS = ("schema", "condition", "mission", "manoeuvre", "number", "use", "sample_period_s")
_UNEVEN = 0.01  # of a sample period


def save_flight(folder: Path, flight: Flight) -> Path:
    """Write both files, the sidecar last, so that it never names what is not there; returns its path."""
    signals = np.column_stack([flight.t_s, flight.u, flight.x, flight.y])
    write_atomic(folder / f"{flight.name}.csv", rows_text(COLUMNS, list(signals.T), None))
    document = tomlkit.document()
    document["schema"] = SCHEMA
    document["condition"] = flight.condition.name
    for key in _KEYS[2:]:
        document[key] = getattr(flight, key)
    path = folder / f"{flight.name}.toml"
    write_atomic(path, tomlkit.dumps(document))
    return path


def load_flights(folder: Path) -> tuple[Flight, ...]:
    """All flight tests of a folder in the order of their names; raises BadInput where there is none, or two are of one name."""
    paths = sorted(folder.glob("*.toml"))
    found = tuple(load_flight(path) for path in paths)
    names = [flight.name for flight in found]
    for path, name in zip(paths, names, strict=True):
        if names.count(name) > 1:
            expected = "condition, mission, manoeuvre and number that differ from every other flight's"
            raise BadInput("flight", str(path), f"a second {name}", expected, "give it another number, or leave it out")
    if not found:
        raise BadInput(
            "flight tests", str(folder), "no TOML file", "sidecars with their CSV files", "name another folder"
        )
    return found


def load_flight(path: Path) -> Flight:
    """Read a sidecar and its CSV; raises BadInput that names file, key or column, and remedy, also for another unit or condition."""
    content, where = read_toml(path, "flight test"), str(path)
    checks.schema(content, where, SCHEMA)
    checks.keys(content, where, _KEYS)
    period_s = checks.positive(content["sample_period_s"], f"{where}: sample_period_s")
    signals = _signals(path.with_suffix(".csv"), period_s)
    u, x, y = np.split(signals, [4, 12], axis=1)
    number = content["number"]
    if not isinstance(number, int) or isinstance(number, bool) or number < 0:
        raise BadInput("number", f"{where}: number", repr(number), "a whole number from 0 on", "count the repetitions")
    flight = Flight(
        condition_of(checks.text(content["condition"], f"{where}: condition")),
        _one_of(content["mission"], tuple(MARGINS), f"{where}: mission"),
        _one_of(content["manoeuvre"], (*CONTROLS, "none"), f"{where}: manoeuvre"),
        number,
        _one_of(content["use"], USES, f"{where}: use"),
        period_s, u, x, y,
    )  # fmt: skip
    demand_sound(flight, str(path.with_suffix(".csv")))
    return flight


def _one_of(value: object, known: Sequence[str], where: str) -> str:
    if value not in known:
        raise BadInput("word", where, repr(value), f"one of {', '.join(known)}", "correct it")
    return str(value)


def _signals(path: Path, period_s: float) -> Array:
    """All columns after the time (n, 15); every sample has to be there, as the model is one of equal steps."""
    names, rows = read_rows(path)
    if names != COLUMNS:
        missing, unknown = (
            [name for name in some if name not in others] for some, others in ((COLUMNS, names), (names, COLUMNS))
        )
        got = "in another order"
        if missing or unknown:
            got = " and ".join(
                [*[f"none called {name}" for name in missing], *[f"an unknown {name}" for name in unknown]]
            )
        raise BadInput("columns", str(path), got, ",".join(COLUMNS), "write these columns in this order")
    for name, column in zip(names, rows.T, strict=True):
        bad = np.flatnonzero(~np.isfinite(column))
        if bad.size:
            got = f"{column[bad[0]]} in {bad.size} of {column.size} rows"
            raise BadInput(
                f"column {name!r}", f"{path}, line {bad[0] + 2}", got, "a finite number in every row",
                "cut the record before it, or leave this flight out",
            )  # fmt: skip
    uneven = np.abs(np.diff(rows[:, 0]) - period_s) > _UNEVEN * period_s
    if np.any(uneven):
        line = int(np.flatnonzero(uneven)[0]) + 3
        raise BadInput("t_s", f"{path}, line {line}", "an uneven step", f"{period_s:g} s", "resample the record")
    return rows[:, 1:]
