"""Import a record of a real rig's dataset, a MATLAB .mat or an MDF4 .mf4 file as a run log: SI units, true times, known limits told.

`twinlaw import quanser_aero model_verification --out mv.csv` writes mv.csv and mv.toml. A dataset without a record lists its records.
`twinlaw import FILE.mat --plant ce150 --column psi_rad=Pitch*0.01745329252 --out run.csv` takes vectors or channels that are named
like the columns of a run log (t_s, u_M_V, ...), or that --column names, with a factor where their unit is another. --from and --until
keep a part, in the record's own time, where not all of it is of the plant: motors off, a wall. --every 5 keeps one row in five, for a
record that is sampled much faster than the plant moves; an input that changed between two kept rows is then late by up to four rows.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from recordings.channels import Choice
from recordings.exported import SUFFIXES, import_file
from recordings.library import IMPORTERS, import_record, records
from records.errors import BadInput
from records.log import LOOPS, RunLog, save_log
from twinlaw.cli import options


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """DATASET, RECORD or FILE, --plant, --column, --loop, --from, --until, --every, --out, --json."""
    parser.add_argument("dataset", metavar="DATASET|FILE", help=f"{', '.join(IMPORTERS)}; or a .mat or .mf4 file")
    parser.add_argument("record", metavar="RECORD", nargs="?", help="left out: list the dataset's records")
    parser.add_argument("--plant", default="ce150", metavar="NAME", help="of a file: its rig; default: %(default)s")
    parser.add_argument(
        "--column",
        type=_choice,
        action="append",
        default=[],
        metavar="COLUMN=CHANNEL[*FACTOR]",
        help="of a file: the channel of a column; may be repeated",
    )
    parser.add_argument("--loop", choices=LOOPS, help="of a file; default: closed where it holds references")
    parser.add_argument("--from", dest="from_s", type=float, metavar="S", help="leave out rows before this time")
    parser.add_argument("--until", dest="until_s", type=float, metavar="S", help="leave out rows after this time")
    parser.add_argument("--every", type=options.count, default=1, metavar="N", help="keep one row in N; default: all")
    parser.add_argument("--out", type=Path, metavar="NAME.csv", help="default: RECORD.csv here")
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Import and write, or list."""
    is_file = Path(chosen.dataset).suffix.lower() in SUFFIXES
    if chosen.record is None and not is_file:
        names = records(chosen.dataset)
        print(json.dumps(names) if chosen.json else "\n".join(names))
        return 0
    if is_file:
        log = import_file(Path(chosen.dataset), chosen.plant, dict(chosen.column), chosen.loop)
    else:
        log = import_record(chosen.dataset, chosen.record)
    path = chosen.out or Path(f"{Path(chosen.dataset if is_file else chosen.record).stem}.csv")
    options.demand_ending(path, ".csv")
    log = _part(log, chosen.from_s, chosen.until_s, chosen.every)
    save_log(path, log)
    _tell(path, log, chosen.json)
    return 0


def _part(log: RunLog, from_s: float | None, until_s: float | None, every: int) -> RunLog:
    """One row in `every` of those within the times that were asked for."""
    if from_s is None and until_s is None and every == 1:
        return log
    inside = (log.t_s >= (-np.inf if from_s is None else from_s)) & (
        log.t_s <= (np.inf if until_s is None else until_s)
    )
    rows = np.flatnonzero(inside)[::every]
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


def _tell(path: Path, log: RunLog, as_json: bool) -> None:
    notes = log.source.notes if log.source else ()
    if as_json:
        print(json.dumps({"log": str(path), "rows": len(log.t_s), "notes": list(notes)}))
    else:
        print(f"{path}  {len(log.t_s)} rows, {log.t_s[-1] - log.t_s[0]:.3f} s", *notes, sep="\n  ")


def _choice(text: str) -> tuple[str, Choice]:
    """COLUMN=CHANNEL or COLUMN=CHANNEL*FACTOR."""
    column, found, channel = text.partition("=")
    if not (found and column and channel):
        raise argparse.ArgumentTypeError(f"got {text[:40]!r}, expected COLUMN=CHANNEL or COLUMN=CHANNEL*FACTOR")
    name, found, factor = channel.rpartition("*")
    try:
        return column, Choice(name, float(factor)) if found and name else Choice(channel)
    except ValueError:
        return column, Choice(channel)  # the channel's own name has the asterisk
