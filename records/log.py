"""The run log: one row per sample of what was measured and commanded, as CSV, with a TOML sidecar that says what flew."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tomlkit
from numpy.typing import NDArray

from records.errors import BadInput
from records.files import demand_writable, write_atomic
from records.logs.clock import demand_seconds
from records.logs.coarse_stamps import own_times
from records.logs.columns import LogColumns
from records.logs.mended import Mended
from records.logs.restarts import counted_on, on_one_clock, restart_rows
from records.logs.rows import check_columns, check_numbers, disordered_rows, from_the_inputs, rising_rows
from records.logs.sidecar import SCHEMA, check_sidecar, read_sidecar
from records.logs.source import Source, parse_source, source_table
from records.logs.unwritten import Unwritten, unwritten_rows
from records.text.log_csv import read_whole_rows, rows_text

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RunLog:
    """A run of n samples: y[k] measured at t_s[k], u[k] commanded from then until t_s[k + 1], after the controller's limits.

    Shapes: t_s (n,), u (n, inputs), y (n, outputs; NaN where nothing was measured), `extra` optional columns (n,), `seq` (n,) the
    board's sequence numbers or None; SI units. `table_digest` names the controller table that flew, None where there was none, and
    `arithmetic` in which its law computed: DOUBLE is a simulation's own, in which no firmware flew; None where nobody said.
    `source` the published recording that the log was imported from, None for a log of this project's own making; `mended` is what of the
    file was not taken as it stands there.
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
    mended: Mended = field(default_factory=Mended)

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


def load_log(path: Path, columns: LogColumns) -> RunLog:
    """Read a run log of the plant that `columns` describes; times, gaps and NaN are kept as they are, and times that begin again count on.

    Rows in front of an input's first number are left out, as nobody knows what moved the plant there, and a few whose time does not
    rise, rows in which nothing was written, and a last one that was written in part; samples of one stamp get times of their own where
    the number of rows tells them.
    Raises BadInput naming file, line and remedy: no file, empty, no sidecar, unknown or missing key or column, another plant, a truncated
    row, a number that is none, time that does not increase, an input that is not finite, a time in another unit.
    """
    sidecar = read_sidecar(path)
    sidecar_path = path.with_suffix(".toml")
    flown = check_sidecar(sidecar, str(sidecar_path), columns)
    names, rows, half_row = read_whole_rows(path, lambda header: check_columns(header, str(path), columns))
    data = {name: rows[:, index] for index, name in enumerate(names)}
    begins = restart_rows(data["t_s"])
    data["t_s"], restarts = on_one_clock(data["t_s"])
    readings = np.column_stack([data[name] for name in columns.outputs])
    commands = np.stack([data[name] for name in columns.inputs], axis=1) if columns.inputs else np.zeros((len(rows), 0))
    data["t_s"], spread = own_times(data["t_s"], readings, str(path))
    kept, late_inputs = from_the_inputs(data, begins, columns)
    rising = rising_rows(data["t_s"])
    disordered = None if rising.all() else disordered_rows(data["t_s"], readings, rising)
    kept &= rising
    empty = kept & unwritten_rows(commands, readings, [data[name] for name in names if name in columns.optional])
    unwritten = Unwritten(int(empty.sum()), float(data["t_s"][empty][0])) if empty.any() else None
    kept &= ~empty
    check_numbers(data, kept, str(path), columns)
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
        mended=Mended(restarts, late_inputs, disordered, unwritten, spread, half_row),
    )
