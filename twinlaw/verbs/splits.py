"""Diagnose every split of a rig's logs into those to explain and those held out: whether all say the same.

A split is diagnosed as `twinlaw diagnose` does it; its files go to DIR/NAME/, named by the logs that were explained. The table goes to
DIR/splits.md, with DIR/splits.json for programs. "Gone" is the share of the removable error on the held-out logs that the effects found
take away: over windows of a second, and left alone from the third second to the logs' ends. The splits with the fewest logs to explain
come first, in the order of the logs. One log by itself is cut in thirds, or in halves where it is short, which go to DIR/parts/.
The splits are diagnosed side by side, and the same command goes on where it was interrupted; their seconds are of processor time.
"""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from records.files import write_atomic
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from twinlaw.cli import console, options
from twinlaw.pages.diagnose import splits as page
from twinlaw.workflows import sweeping
from twinlaw.workflows.diagnose.files import writable
from twinlaw.workflows.diagnose.partitions import count_of, cut, splits_of
from twinlaw.workflows.diagnose.splits import consistency, diagnosed, facts

SCHEMA = "splits/1"
MOST_SPLITS = 12  # of them by default: all of three logs, all but two of four


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --most, --workers, --cluster, --out, --json, LOG ..."""
    options.plant(parser)
    parser.add_argument(
        "--most", type=options.count, default=MOST_SPLITS, metavar="N", help="splits; default: %(default)s"
    )
    sweeping.workers(parser)
    options.out(parser)
    options.as_json(parser)
    parser.add_argument("logs", type=Path, nargs="+", metavar="LOG.csv", help="logs of one rig")


def run(chosen: argparse.Namespace) -> int:
    """Diagnose all, write, and print the table with how far the names agree."""
    options.differing(chosen.logs)
    with writable(chosen.out):
        logs, remarks = chosen.logs, []
        if len(logs) == 1:
            columns = log_columns(bind(load_plant(chosen.plant)).model)
            logs = cut(logs[0], columns, chosen.out / "parts")
            remarks.append(f"{chosen.logs[0].stem} by itself is cut in {len(logs)} parts.")
        asked = splits_of(chosen.plant, logs, chosen.most)
        if len(asked) < count_of(logs):
            remarks.append(f"These are the first {len(asked)} of {count_of(logs)} splits.")
        found = list(diagnosed(asked, chosen.out, sweeping.crew_of(chosen)))
        agreed, splits = asdict(consistency(found)), facts(found)
        remarks.append(page.agreement(agreed, splits))
        told = {"schema": SCHEMA, "splits": splits, "consistency": agreed, "remarks": remarks}
        write_atomic(chosen.out / "splits.json", json.dumps(told, indent=1) + "\n")
        write_atomic(chosen.out / "splits.md", "\n".join([page.markdown(splits), *remarks]) + "\n")
    table = console.table(page.rows(splits), page.HEADING)
    print(json.dumps(told) if chosen.json else "\n".join([table, "", *remarks]))
    return sweeping.failures([("+".join(entry.explained), entry.failure) for entry in found])
