"""Design the controller of a plant at its operating points, fit it, judge it, and write the table.

Writes DIR/controller.json and, of the scheduled law, DIR/design.html. Refuses (exit 2) a table that is unstable or below its margins
anywhere in the range. The table serves both arithmetics: --arithmetic says in which its poles and margins are computed, and a table
without a law in it is refused.
--controller chooses another controller of docs/controllers.md; `build`, `flash`, `validate`, `watch` and `simulate` take its table as well.
--tune SEED looks for what its design leaves open by flying the plant, a few minutes long, and writes DIR/tuned.toml, the section of the
plant file that keeps it.
"""

import argparse
import json

from controllers.table import CONTROLLERS
from records.files import write_atomic
from records.table import table_text
from twinlaw.cli import console, options
from twinlaw.pages.page import page_text
from twinlaw.pages.run.design import design_facts, design_heading, design_rows
from twinlaw.pages.run.design_page import design_page
from twinlaw.workflows.chain.designing import design_controller, design_other
from twinlaw.workflows.comparing import tuned_text
from twinlaw.workflows.reading import load_bound

SCHEDULED = "scheduled"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --controller, --tune, --arithmetic, --out, --json."""
    options.plant(parser)
    parser.add_argument(
        "--controller", choices=tuple(CONTROLLERS), default=SCHEDULED, metavar="NAME",
        help=f"one of {', '.join(CONTROLLERS)}; default: %(default)s",
    )  # fmt: skip
    parser.add_argument(
        "--tune", type=options.count, metavar="SEED", help="look for the controller's open numbers, from this seed"
    )
    options.arithmetic(parser)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Design, write and tell."""
    if chosen.tune is not None:
        write_atomic(chosen.out / "tuned.toml", tuned_text(load_bound(chosen.plant), chosen.controller, chosen.tune))
        print(json.dumps({"tuned": str(chosen.out / "tuned.toml")}) if chosen.json else chosen.out / "tuned.toml")
        return 0
    if chosen.controller != SCHEDULED:
        return _other(chosen)
    designed = design_controller(chosen.plant, chosen.arithmetic)
    path = chosen.out / "controller.json"
    write_atomic(path, table_text(designed.table))
    page = design_page(designed.bound.plant.name, designed.report, designed.table.digest)
    write_atomic(chosen.out / "design.html", page_text(page))
    if chosen.json:
        print(json.dumps({"table": str(path), "table_digest": designed.table.digest, **design_facts(designed.report)}))
    else:
        print(console.table(design_rows(designed.report), design_heading(designed.report)))
        print(f"\n{path}  digest {designed.table.digest[:16]}")
    return 0


def _other(chosen: argparse.Namespace) -> int:
    """The same for a controller that is not scheduled pole placement."""
    row, table = CONTROLLERS[chosen.controller], design_other(chosen.plant, chosen.controller, chosen.arithmetic)
    path = chosen.out / "controller.json"
    write_atomic(path, row.text(table))
    if chosen.json:
        print(json.dumps({"table": str(path), "table_digest": table.digest, "controller": row.name}))
    else:
        print(f"{row.title}, {row.source}\n\n{path}  digest {table.digest[:16]}")
    return 0
