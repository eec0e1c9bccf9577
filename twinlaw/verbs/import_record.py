"""Import a log of another tool, or a record of a published data set, as a run log: SI units, true times, known limits told.

`twinlaw import FILE --plant ce150 --column psi_rad='Pitch [deg]' --out run.csv` takes tables of text, workbooks, MATLAB, MDF, TDMS, PX4,
Parquet and ROS files. A column is the signal of its own name, or what --column says: arithmetic over the file's names, as in
psi_rad="elevation_deg*pi/180" or u_M_V="ScopeData.signals(1).values(:,2)", for the times t_s too; known units convert by themselves.
--mapping FILE.toml uses what is kept there and keeps what is said here for the next log. What was found unasked is told. `twinlaw import
quanser_aero model_verification --out mv.csv` imports a record of a data set; a data set without a record lists its records. --from and
--until keep a part, in the record's own time, as if the rest had not been recorded. --every 5 keeps one row in five, for a record that is
sampled much faster than the plant moves; an input that changed between two kept rows is then late by up to four rows.
"""

import argparse
import json
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from recordings.channels import Span
from recordings.datasets.library import IMPORTERS, import_record, records
from recordings.formats import compressed, table
from recordings.importing import DEFAULT_PLANT, Imported, columns_of, import_file
from recordings.layout import TextLayout
from recordings.mapping.mapping import ColumnMapping, load_mapping, save_mapping
from recordings.proposal import overview, proposed
from recordings.signals import Unmapped
from records.errors import BadInput
from records.files import demand_writable, place_of
from records.log import RunLog, save_log
from records.logs.sidecar import LOOPS
from twinlaw.cli import console, options


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """DATASET, RECORD or FILE, the mapping, --from, --until, --every, --out, --json."""
    parser.add_argument(
        "dataset", metavar="DATASET|FILE", help=f"{', '.join(IMPORTERS)}; or a {', '.join(table.SUFFIXES)} file"
    )
    parser.add_argument("record", metavar="RECORD", nargs="?", help="left out: list the dataset's records")
    parser.add_argument("--plant", metavar="PLANT", help="of a file: its rig, by name or plant file; default: ce150")
    text = "of a file: what gives a column; may be repeated"
    parser.add_argument("--column", type=_column, action="append", default=[], metavar="NAME=EXPRESSION", help=text)
    parser.add_argument(
        "--mapping", type=Path, metavar="FILE.toml", help="of a file: columns and options from there, kept there"
    )
    parser.add_argument(
        "--group",
        metavar="NAME",
        help="of a file: the group, structure or topic that is meant where several have a name",
    )
    parser.add_argument(
        "--per-turn", type=_positive, metavar="N", help="of a file: counts of one turn of an encoder, all edges counted"
    )
    parser.add_argument(
        "--separator",
        metavar="SIGN",
        help="of a table of text: between cells, a sign or `tab`, `blanks`; default: found",
    )
    parser.add_argument(
        "--decimal", choices=(".", ","), metavar="SIGN", help="of a table of text: point or comma; default: found"
    )
    parser.add_argument(
        "--skip",
        type=options.count,
        default=0,
        metavar="LINES",
        help="of a table of text: pass these over at its beginning",
    )
    parser.add_argument("--loop", choices=LOOPS, help="of a file; default: closed where it holds references")
    parser.add_argument("--from", dest="from_s", type=float, metavar="S", help="leave out all before this time")
    parser.add_argument("--until", dest="until_s", type=float, metavar="S", help="leave out all after this time")
    parser.add_argument("--every", type=options.count, default=1, metavar="N", help="keep one row in N; default: all")
    parser.add_argument("--out", type=Path, metavar="NAME.csv", help="default: the record's or file's own name, here")
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Import and write, or list."""
    said = _said(chosen)
    if chosen.dataset not in IMPORTERS and table.is_file(chosen.dataset):
        if chosen.record is not None:
            raise BadInput("RECORD", chosen.dataset, repr(chosen.record), "nothing behind a file", "leave it out")
        return _import_file(chosen, said)
    if said != ColumnMapping() or chosen.mapping is not None:
        got = "an option of a file, such as --column or --mapping"
        raise BadInput("option", f"data set {chosen.dataset}", got, "its record alone", "leave it out")
    if chosen.record is None:
        names = records(chosen.dataset)
        print(json.dumps(names) if chosen.json else "\n".join(names))
        return 0
    out = _out(chosen, chosen.record)
    log = _every(_part(import_record(chosen.dataset, chosen.record), _span(chosen)), chosen.every)
    save_log(out, log)
    _tell(out, log, (), {}, chosen.json)
    return 0


def _import_file(chosen: argparse.Namespace, said: ColumnMapping) -> int:
    path = Path(chosen.dataset)
    if not path.exists():
        raise BadInput("file", str(path), "no such file", "a readable file", "check the path")
    out = _out(chosen, chosen.dataset)
    if place_of(out) == place_of(path):
        raise BadInput("--out", str(out), "the recording itself", "another name", "name the log with --out NAME.csv")
    if chosen.mapping is not None and place_of(chosen.mapping) == place_of(out.with_suffix(".toml")):
        raise BadInput(
            "--mapping", str(chosen.mapping), "the log's own sidecar", "another name", "call it NAME-mapping.toml"
        )
    there = chosen.mapping is not None and chosen.mapping.exists()
    if chosen.mapping is not None:
        demand_writable(chosen.mapping)
    mapping = said.over(load_mapping(chosen.mapping) if there else ColumnMapping())
    try:
        imported = import_file(path, mapping, _span(chosen))
    except Unmapped:
        if not mapping.columns and sys.stdout.isatty() and not chosen.json:
            _show(path, mapping)
        raise
    log = _every(imported.log, chosen.every)
    save_log(out, log)
    kept = (
        [f"mapping kept in {chosen.mapping}"]
        if chosen.mapping and save_mapping(chosen.mapping, _to_keep(imported, mapping))
        else []
    )
    _tell(out, log, (*imported.found, *kept), imported.mapping.columns, chosen.json)
    return 0


def _show(path: Path, mapping: ColumnMapping) -> None:
    """The file's signals with their ranges, and a command that maps them, for a person who has not seen the file from inside."""
    contents, plant = table.read(path, mapping.layout), mapping.plant or DEFAULT_PLANT
    print(*contents.found, "", sep="\n")
    print(console.table(overview(contents), ("signal", "unit", "samples", "least", "greatest", "clock")))
    lines = [f"twinlaw import {shlex.quote(str(path))} --plant {shlex.quote(plant)}"]
    lines += [*proposed(contents, columns_of(plant), {}), f"--mapping {shlex.quote(f'{path.stem}-mapping.toml')}"]
    print("\na mapping to begin with:\n\n  " + " \\\n    ".join(lines) + "\n", flush=True)


def _to_keep(imported: Imported, mapping: ColumnMapping) -> ColumnMapping:
    """The mapping of all columns that this import found; how text is laid out only where it was said."""
    return replace(imported.mapping, layout=mapping.layout)


def _said(chosen: argparse.Namespace) -> ColumnMapping:
    """What the command line says of the mapping; raises BadInput for a column twice."""
    names = [name for name, _ in chosen.column]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise BadInput(
            f"column {twice[0]!r}", "--column", f"{names.count(twice[0])} expressions", "one", "leave one out"
        )
    return ColumnMapping(
        columns=dict(chosen.column),
        plant=chosen.plant,
        loop=chosen.loop,
        group=chosen.group,
        per_turn=chosen.per_turn,
        layout=TextLayout(chosen.separator, chosen.decimal, chosen.skip),
    )


def _out(chosen: argparse.Namespace, name: str) -> Path:
    out: Path = chosen.out or Path(f"{Path(compressed.without_suffix(name)).stem}.csv")
    options.demand_ending(out, ".csv")
    return out


def _span(chosen: argparse.Namespace) -> Span:
    """The part that is asked for."""
    return Span(
        -np.inf if chosen.from_s is None else chosen.from_s, np.inf if chosen.until_s is None else chosen.until_s
    )


def _part(log: RunLog, span: Span) -> RunLog:
    """The rows of a record within the times that were asked for."""
    return log if span == Span() else _rows(log, np.flatnonzero(span.holds(log.t_s)), 1)


def _every(log: RunLog, every: int) -> RunLog:
    """One row in `every`."""
    return log if every == 1 else _rows(log, np.arange(0, len(log.t_s), every), every)


def _rows(log: RunLog, rows: np.ndarray, every: int) -> RunLog:
    if len(rows) < 2:
        within = f"two or more of the record's, {len(log.t_s)} from {log.t_s[0]:g} s to {log.t_s[-1]:g} s"
        remedy = "choose other times, or a smaller step"
        raise BadInput("part of a record", "--from, --until, --every", f"{len(rows)} rows", within, remedy)
    return replace(
        log,
        sample_period_s=every * log.sample_period_s,
        t_s=log.t_s[rows],
        u=log.u[rows],
        y=log.y[rows],
        extra={name: column[rows] for name, column in log.extra.items()},
        seq=None if log.seq is None or every > 1 else log.seq[rows],  # else the rows left out would look lost
    )


def _tell(path: Path, log: RunLog, found: Sequence[str], columns: Mapping[str, str], as_json: bool) -> None:
    notes = log.source.notes if log.source else ()
    if as_json:
        told = {
            "log": str(path),
            "rows": len(log.t_s),
            "notes": list(notes),
            "found": list(found),
            "columns": dict(columns),
        }
        print(json.dumps(told))
    else:
        lines = (f"{path}  {len(log.t_s)} rows, {log.t_s[-1] - log.t_s[0]:.3f} s", *found, *notes)
        print(*lines, sep="\n  ")


def _column(text: str) -> tuple[str, str]:
    """NAME=EXPRESSION, as the type of an option."""
    column, found, expression = text.partition("=")
    if not (found and column.strip() and expression.strip()):
        raise argparse.ArgumentTypeError(f"got {text[:40]!r}, expected NAME=EXPRESSION")
    return column.strip(), expression.strip()


def _positive(text: str) -> float:
    """A number above 0, as the type of an option."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < np.inf:
        raise argparse.ArgumentTypeError(f"got {text[:30]!r}, expected a number above 0")
    return value
