"""The run log: one row per sample of what was measured and commanded, as CSV, with a TOML sidecar that says what flew."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from numpy.typing import NDArray

from records.errors import BadInput
from records.files import demand_writable, write_atomic
from records.logs.clock import demand_seconds
from records.logs.coarse_stamps import Spread, own_times
from records.logs.restarts import Restart, counted_on, on_one_clock, restart_rows
from records.logs.source import Source, parse_source, source_table
from records.logs.unwritten import Unwritten, unwritten_rows
from records.text import checks
from records.text.last_row import HalfRow
from records.text.log_csv import read_whole_rows, rows_text
from records.text.reading import read_toml

SCHEMA = "run-log/1"
MOST_DISORDERED = 0.1  # of a log's rows: with more the file is in no order, or its times are no times
LOOPS = ("open", "closed")
DOUBLE = "float64"
ARITHMETICS = (DOUBLE, "float32", "fixed")
Array = NDArray[np.float64]


@dataclass(frozen=True)
class LogColumns:
    """Columns of a plant's logs: its inputs and outputs always, any of `optional`, after `t_s`; `axes` can be locked."""

    plant: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    optional: tuple[str, ...]
    axes: tuple[str, ...]


@dataclass(frozen=True)
class Disordered:
    """Rows of a file whose time does not rise: how many, the first one's time; and where the log goes on behind such as are no row
    written again, with how many these were."""

    rows: int
    first_s: float
    went_back: tuple[tuple[float, int], ...] = ()


@dataclass(frozen=True)
class LateInput:
    """An input that begins at `begins_s`, behind so many rows of a recording in which the outputs alone stand; these are left out."""

    column: str
    begins_s: float
    rows: int


@dataclass(frozen=True, eq=False)
class RunLog:
    """A run of n samples: y[k] measured at t_s[k], u[k] commanded from then until t_s[k + 1], after the controller's limits.

    Shapes: t_s (n,), u (n, inputs), y (n, outputs; NaN where nothing was measured), `extra` optional columns (n,), `seq` (n,) the
    board's sequence numbers or None; SI units. `table_digest` names the controller table that flew, None where there was none, and
    `arithmetic` in which its law computed: DOUBLE is a simulation's own, in which no firmware flew; None where nobody said.
    `source` the published recording that the log was imported from, None for a log of this project's own making; `restarts` are where
    another recording of the same file begins, whose times are counted on; `late_inputs` begin behind a recording's first row;
    `disordered` and `unwritten` are rows of the file that were left out, `spread` those whose stamps were too coarse to tell them apart,
    `half_row` the last one where it was written in part.
    """

    columns: LogColumns
    sample_period_s: float
    loop: str
    t_s: Array
    u: Array
    y: Array
    extra: Mapping[str, Array] = field(default_factory=dict)
    seq: NDArray[np.int64] | None = None
    locked: tuple[str, ...] = ()
    table_digest: str | None = None
    arithmetic: str | None = None
    source: Source | None = None
    restarts: tuple[Restart, ...] = ()
    late_inputs: tuple[LateInput, ...] = ()
    disordered: Disordered | None = None
    unwritten: Unwritten | None = None
    spread: Spread | None = None
    half_row: HalfRow | None = None

    def column(self, name: str) -> Array:
        """The column called `name`, shape (n,); raises KeyError for one that is not there."""
        if name == "t_s":
            return self.t_s
        if name in self.columns.inputs:
            return self.u[:, self.columns.inputs.index(name)]
        if name in self.columns.outputs:
            return self.y[:, self.columns.outputs.index(name)]
        return self.extra[name]


def save_log(path: Path, log: RunLog) -> None:
    """Write `path` (CSV) and its sidecar NAME.toml; reading them back gives the same numbers. Raises BadInput when unwritable."""
    demand_log_name(path)
    sidecar = sidecar_text(log)
    write_atomic(path, csv_text(log))
    try:
        write_atomic(path.with_suffix(".toml"), sidecar)
    except BadInput:
        path.unlink(missing_ok=True)
        raise


def demand_log_name(path: Path) -> None:
    """Raise BadInput where the log would have the name of its own sidecar, or of a folder."""
    if path.suffix == ".toml" or path.is_dir():
        got = "a folder" if path.is_dir() else "the name of a log's sidecar"
        raise BadInput("run log", str(path), got, "a file NAME.csv", "choose another name")


def demand_log_place(path: Path) -> None:
    """Raise BadInput now where `save_log` would later find that nothing can be written there, after a flight that is lost then."""
    demand_log_name(path)
    demand_writable(path)


def csv_text(log: RunLog) -> str:
    """The rows as CSV text; numbers print so that they read back exactly."""
    names = ["t_s", *log.columns.inputs, *log.columns.outputs, *log.extra]
    return rows_text(names, [log.column(name) for name in names], log.seq)


def sidecar_text(log: RunLog) -> str:
    """The sidecar as TOML text."""
    document = tomlkit.document()
    document["schema"] = SCHEMA
    document["plant"] = log.columns.plant
    document["sample_period_s"] = log.sample_period_s
    document["loop"] = log.loop
    document["locked"] = list(log.locked)
    if log.table_digest is not None:
        stated = {} if log.arithmetic is None else {"arithmetic": log.arithmetic}
        document["controller"] = {"table_digest": log.table_digest} | stated
    if log.source is not None:
        document["source"] = source_table(log.source)
    return tomlkit.dumps(document)


def facts_of_sidecar(text: str, where: str, columns: LogColumns) -> dict[str, Any]:
    """`loop`, `locked`, `table_digest` and `arithmetic` of a sidecar's text, by these names; none of a text that is no sidecar.

    Raises BadInput for a sidecar of another plant, or one that is wrong.
    """
    try:
        sidecar = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return {}
    if sidecar.get("schema") != SCHEMA:
        return {}
    flown = _check_sidecar(sidecar, where, columns)
    return {"loop": sidecar["loop"], "locked": tuple(sidecar["locked"]), **flown}


def load_log(path: Path, columns: LogColumns) -> RunLog:
    """Read a run log of the plant that `columns` describes; times, gaps and NaN are kept as they are, and times that begin again count on.

    Rows in front of an input's first number are left out, as nobody knows what moved the plant there, and a few whose time does not
    rise, rows in which nothing was written, and a last one that was written in part; samples of one stamp get times of their own where
    the number of rows tells them.
    Raises BadInput naming file, line and remedy: no file, empty, no sidecar, unknown or missing key or column, another plant, a truncated
    row, a number that is none, time that does not increase, an input that is not finite, a time in another unit.
    """
    sidecar_path = path.with_suffix(".toml")
    sidecar = _sidecar(path)
    flown = _check_sidecar(sidecar, str(sidecar_path), columns)
    names, rows, half_row = read_whole_rows(path, lambda header: _check_columns(header, str(path), columns))
    data = {name: rows[:, index] for index, name in enumerate(names)}
    begins = restart_rows(data["t_s"])
    data["t_s"], restarts = on_one_clock(data["t_s"])
    readings = np.column_stack([data[name] for name in columns.outputs])
    commands = np.stack([data[name] for name in columns.inputs], axis=1) if columns.inputs else np.zeros((len(rows), 0))
    data["t_s"], spread = own_times(data["t_s"], readings, str(path))
    kept, late_inputs = _from_the_inputs(data, begins, columns)
    rising = _rising(data["t_s"])
    disordered = None if rising.all() else _disordered(data["t_s"], readings, rising)
    kept &= rising
    empty = kept & unwritten_rows(commands, readings, [data[name] for name in names if name in columns.optional])
    unwritten = Unwritten(int(empty.sum()), float(data["t_s"][empty][0])) if empty.any() else None
    kept &= ~empty
    _check_numbers(data, kept, str(path), columns)
    demand_seconds(data["t_s"], float(sidecar["sample_period_s"]), str(path))
    seq = counted_on(data["seq"].astype(np.int64), begins)[kept] if "seq" in data else None
    data = {name: values[kept] for name, values in data.items()}
    return RunLog(
        columns=columns,
        sample_period_s=float(sidecar["sample_period_s"]),
        loop=sidecar["loop"],
        t_s=data["t_s"].copy(),
        u=commands[kept],
        y=np.column_stack([data[name] for name in columns.outputs]),
        extra={name: data[name].copy() for name in names if name in columns.optional},
        seq=seq,
        locked=tuple(sidecar["locked"]),
        **flown,
        source=parse_source(sidecar["source"], f"{sidecar_path}: source") if "source" in sidecar else None,
        restarts=restarts,
        late_inputs=late_inputs,
        disordered=disordered,
        unwritten=unwritten,
        spread=spread,
        half_row=half_row,
    )


def _rising(t_s: Array) -> NDArray[np.bool_]:
    """Rows (n,) whose time is later than all before, of one time the last, whose command holds; all rows where more than MOST_DISORDERED
    are not, as then the clock is no clock."""
    ends = np.flatnonzero(np.diff(t_s, append=np.inf) != 0.0)
    first = np.concatenate([[True], t_s[1:] > np.maximum.accumulate(t_s)[:-1]])
    rising = np.zeros(len(t_s), bool)
    rising[ends[np.searchsorted(ends, np.flatnonzero(first))]] = True
    few = bool(np.isfinite(t_s).all()) and float((~rising).mean()) <= MOST_DISORDERED
    return rising if few else np.ones(len(t_s), bool)


def _disordered(t_s: Array, y: Array, rising: NDArray[np.bool_]) -> Disordered:
    """What is to be known of the rows (n,) that do not rise; those that are written again, reading for reading, went back by nothing."""
    kept = np.flatnonzero(rising)
    first = kept[np.minimum(np.searchsorted(t_s[kept], t_s), len(kept) - 1)]
    again = (t_s == t_s[first]) & ((y == y[first]) | np.isnan(y)).all(axis=1)
    back = (t_s < np.maximum.accumulate(t_s)) & ~again
    edges = np.flatnonzero(np.diff(back, prepend=False, append=False)).reshape(-1, 2)
    later = [(kept[kept >= last], last - first) for first, last in edges.tolist()]
    went_back = tuple((float(t_s[on[0]]), count) for on, count in later if on.size)
    return Disordered(int((~rising).sum()), float(t_s[~rising][0]), went_back)


def _from_the_inputs(
    data: Mapping[str, Array], begins: NDArray[np.int64], columns: LogColumns
) -> tuple[NDArray[np.bool_], tuple[LateInput, ...]]:
    """Rows (n,) but those that stand in front of an input's first number at the head of a recording, and what was left out."""
    kept = np.ones(len(data["t_s"]), bool)
    found = []
    for first, behind in pairwise([0, *begins.tolist(), len(kept)]):
        known = {name: ~np.isnan(data[name][first:behind]) for name in columns.inputs}
        rows = {name: int(np.argmax(there)) for name, there in known.items() if there.any()}
        last = max(rows, key=lambda name: rows[name], default=None)
        if last is None or not rows[last] or len(rows) < len(known):
            continue  # what never begins is refused with its line
        kept[first : first + rows[last]] = False
        found.append(LateInput(last, float(data["t_s"][first + rows[last]]), rows[last]))
    return kept, tuple(found)


def plant_of_log(path: Path) -> str:
    """The name of the plant that a log's sidecar states; raises BadInput."""
    sidecar_path = path.with_suffix(".toml")
    sidecar = _sidecar(path)
    checks.keys(sidecar, str(sidecar_path), ("plant",), sidecar.keys())
    return checks.text(sidecar["plant"], f"{sidecar_path}: plant")


def _sidecar(path: Path) -> Mapping[str, Any]:
    """What stands beside the log at `path`; a log that is not there at all is told by its own name."""
    if not path.exists():
        raise BadInput("run log", str(path), "No such file or directory", "a readable file", "check the path")
    beside = "a log is NAME.csv with NAME.toml beside it; `twinlaw import` makes both of a recording"
    return read_toml(path.with_suffix(".toml"), "sidecar of the run log", beside)


def _check_sidecar(sidecar: Mapping[str, Any], where: str, columns: LogColumns) -> dict[str, str | None]:
    """Check every key; returns `table_digest` and `arithmetic` of the controller that flew, None where they are not named."""
    checks.schema(sidecar, where, SCHEMA)
    checks.keys(sidecar, where, ("schema", "plant", "sample_period_s", "loop", "locked"), ("controller", "source"))
    if checks.text(sidecar["plant"], f"{where}: plant") != columns.plant:
        raise BadInput(
            "plant", where, repr(sidecar["plant"]), repr(columns.plant), "give the log and the plant of one rig"
        )
    checks.positive(sidecar["sample_period_s"], f"{where}: sample_period_s")
    if sidecar["loop"] not in LOOPS:
        raise BadInput(
            "loop", where, repr(sidecar["loop"]), " or ".join(map(repr, LOOPS)), "say how the inputs were made"
        )
    locked = sidecar["locked"]
    if not isinstance(locked, list) or any(axis not in columns.axes for axis in locked):
        raise BadInput("locked", where, repr(locked), f"a list of {', '.join(columns.axes)}", "name axes of this plant")
    if "controller" not in sidecar:
        return {"table_digest": None, "arithmetic": None}
    controller = checks.table(sidecar["controller"], f"{where}: controller")
    checks.keys(controller, f"{where}: controller", ("table_digest",), ("arithmetic",))
    digest, arithmetic = controller["table_digest"], controller.get("arithmetic")
    if arithmetic not in (None, *ARITHMETICS):
        expected, remedy = " or ".join(map(repr, ARITHMETICS)), "say in which arithmetic the law computed, or remove it"
        raise BadInput("arithmetic", f"{where}: controller", repr(arithmetic), expected, remedy)
    return {"table_digest": checks.text(digest, f"{where}: controller.table_digest"), "arithmetic": arithmetic}


def _check_columns(names: tuple[str, ...], where: str, columns: LogColumns) -> None:
    needed = ("t_s", *columns.inputs, *columns.outputs)
    for name in needed:
        if name not in names:
            shown = ",".join(names)
            got = f"the header {shown if len(shown) < 200 else f'{shown[:197]}...'!r}, cells separated by commas"
            remedy = f"a log of {columns.plant} needs {','.join(needed)}; `twinlaw import` makes one of any other table"
            raise BadInput(f"column {name!r}", where, got, "a column of that name", remedy)
    for name in names:
        if name not in (*needed, *columns.optional, "seq"):
            known = ", ".join((*needed, "seq", *columns.optional))
            raise BadInput(f"column {name!r}", where, "an unknown column", f"one of {known}", "remove or rename it")
    if len(set(names)) != len(names):
        raise BadInput("header", where, "a column twice", "each column once", "remove the second")


def _no_number(values: Array, bad: NDArray[np.intp]) -> str:
    """The first of the values at the places `bad`, and in how many rows such stand."""
    first = float(values[bad[0]])
    told = "nan or an empty cell" if np.isnan(first) else repr(first)
    return told if len(bad) == 1 else f"{told}, and no number in {len(bad) - 1} more row{'s' if len(bad) > 2 else ''}"


def _check_numbers(data: Mapping[str, Array], kept: NDArray[np.bool_], where: str, columns: LogColumns) -> None:
    """Raise BadInput for a number that cannot be, in an input only where its rows are `kept` (n,)."""
    for name in ("t_s", *columns.inputs, *(["seq"] if "seq" in data else [])):
        bad = np.flatnonzero(~np.isfinite(data[name]) & (kept if name in columns.inputs else True))
        if bad.size:
            raise BadInput(
                f"column {name!r}",
                f"{where}, line {bad[0] + 2}",
                _no_number(data[name], bad),
                "a finite number",
                "remove such rows" + (", or write what the controller sent there" if name in columns.inputs else ""),
            )
    if "seq" in data and np.any(data["seq"] != np.round(data["seq"])):
        row = int(np.flatnonzero(data["seq"] != np.round(data["seq"]))[0])
        raise BadInput(
            "column 'seq'", f"{where}, line {row + 2}", repr(float(data["seq"][row])), "a whole number", "mend the row"
        )
    for name in (*columns.outputs, *(name for name in columns.optional if name in data)):
        bad = np.flatnonzero(np.isinf(data[name]))
        if bad.size:
            raise BadInput(
                f"column {name!r}",
                f"{where}, line {bad[0] + 2}",
                "an infinity",
                "a number, or NaN where none was measured",
                "write nan",
            )
    late = np.flatnonzero(np.diff(data["t_s"]) <= 0.0)
    if late.size and bool(_rising(data["t_s"]).all()):
        row = int(late[0]) + 1
        raise BadInput(
            "t_s",
            f"{where}, line {row + 2}",
            f"{data['t_s'][row]:g} after {data['t_s'][row - 1]:g}",
            "a time that increases",
            "sort the rows and remove repeated ones, or let `twinlaw import` leave them out",
        )
