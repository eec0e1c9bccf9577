"""Import a record of a real rig's dataset as a run log: SI units, true times, known limits told.

`twinlaw import quanser_aero model_verification --out mv.csv` writes mv.csv and mv.toml. A dataset without a record lists its records.
"""

import argparse
import json
from pathlib import Path

from recordings.library import IMPORTERS, import_record, records
from records.log import save_log
from twinlaw import options


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """DATASET, RECORD, --out, --json."""
    parser.add_argument("dataset", metavar="DATASET", help=", ".join(IMPORTERS))
    parser.add_argument("record", metavar="RECORD", nargs="?", help="left out: list the dataset's records")
    parser.add_argument("--out", type=Path, metavar="NAME.csv", help="default: RECORD.csv here")
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Import and write, or list."""
    if chosen.record is None:
        names = records(chosen.dataset)
        print(json.dumps(names) if chosen.json else "\n".join(names))
        return 0
    log = import_record(chosen.dataset, chosen.record)
    path = chosen.out or Path(f"{Path(chosen.record).stem}.csv")
    save_log(path, log)
    notes = log.source.notes if log.source else ()
    if chosen.json:
        print(json.dumps({"log": str(path), "rows": len(log.t_s), "notes": list(notes)}))
    else:
        print(f"{path}  {len(log.t_s)} rows, {log.t_s[-1] - log.t_s[0]:.3f} s", *notes, sep="\n  ")
    return 0
