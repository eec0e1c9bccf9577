"""Export a run log as an ASAM MDF4 file (.mf4) for measurement tools; needs the optional extra `mdf4`.

`twinlaw export build/run.csv --out run.mf4` keeps every column with its unit, the log's true times, and what its sidecar says.
"""

import argparse
import json
from pathlib import Path

from recordings.formats.mdf4_export import mdf4_bytes
from records.files import write_atomic
from twinlaw.cli import options
from twinlaw.workflows.reading import load_bound, load_known_log


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """LOG.csv, --plant, --out, --json."""
    parser.add_argument("log", type=Path, metavar="LOG.csv")
    parser.add_argument(
        "--plant",
        type=options.plant_file,
        metavar="PLANT.toml",
        help="of a log of a plant of your own; default: a plant of the project",
    )
    parser.add_argument("--out", type=Path, metavar="NAME.mf4", help="default: LOG.mf4 beside the log")
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Read, convert, write."""
    if chosen.out is not None:
        options.demand_ending(chosen.out, ".mf4")
    log = load_known_log(chosen.log, None if chosen.plant is None else load_bound(chosen.plant))
    out: Path = chosen.out or chosen.log.with_suffix(".mf4")
    write_atomic(out, mdf4_bytes(log))
    told = {"mf4": str(out), "rows": len(log.t_s)}
    print(json.dumps(told) if chosen.json else f"{out}  {len(log.t_s)} rows")
    return 0
