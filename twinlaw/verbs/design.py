"""Design the controller of a plant at its operating points, fit it, judge it, and write the table.

Writes DIR/controller.json. Refuses (exit 2) a table that is unstable or below its margins anywhere in the range.
"""

import argparse
import json

from records.files import write_atomic
from records.table import table_text
from twinlaw import console, options, summary
from twinlaw.stages import design_controller


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --out, --json."""
    options.plant(parser)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Design, write and tell."""
    designed = design_controller(chosen.plant)
    path = chosen.out / "controller.json"
    write_atomic(path, table_text(designed.table))
    if chosen.json:
        print(
            json.dumps(
                {"table": str(path), "table_digest": designed.table.digest, **summary.design_facts(designed.report)}
            )
        )
    else:
        print(console.table(summary.design_rows(designed.report), summary.DESIGN_HEADING))
        print(f"\n{path}  digest {designed.table.digest[:16]}")
    return 0
