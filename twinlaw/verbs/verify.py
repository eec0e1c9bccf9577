"""Verify a controller table: twin, compiled C and firmware image step by step, bit by bit; bounds; cost on the target.

Writes DIR/verification.json, with the generated C and the image that were verified. --log replays what a run log recorded through
all three as well; a log that another table flew is refused. Exit status 1 when a check does not hold.
"""

import argparse
from pathlib import Path

from records.files import write_atomic
from records.table import load_table
from records.verification import verification_text
from twinlaw import console, options, summary
from twinlaw.stages import (
    STEPS,
    build_image,
    demand,
    generate_sources,
    load_bound,
    recorded_replay,
    table_poles,
    verify_table,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --table, --arithmetic, --log, --steps, --out, --json."""
    options.plant(parser)
    options.table(parser)
    options.arithmetic(parser)
    parser.add_argument(
        "--log", type=Path, action="append", default=[], metavar="LOG.csv", help="replay it too; may be repeated"
    )
    parser.add_argument("--steps", type=options.count, default=STEPS, help="compared at least; default: %(default)s")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Check, write, tell, and fail where a check does not hold."""
    table = load_table(chosen.table)
    recorded = [recorded_replay(path, table, chosen.arithmetic) for path in chosen.log]
    bound = load_bound(chosen.plant)
    poles = table_poles(bound, table)
    law = generate_sources(table, chosen.arithmetic, chosen.out / "generated")
    image = build_image(law, chosen.out)
    verification = verify_table(bound, table, poles, law, image, recorded, chosen.steps, chosen.arithmetic)
    text = verification_text(verification)
    write_atomic(chosen.out / "verification.json", text)
    print(text if chosen.json else console.table(summary.verification_rows(verification)))
    demand(verification)
    return 0
