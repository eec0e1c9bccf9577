"""Verify a controller table: twin, compiled C and firmware image step by step, bit by bit; bounds; cost on the target.
--chip runs the law on the core of that chip; of one that is not emulated as a whole there is no cost, and no proof of it.

Writes DIR/verification.json, with the generated C and the image that were verified. --log replays what a run log recorded through
all three as well; a log that another table flew is refused. --proofs adds what the tools of docs/proofs.md prove; one that is
absent is named and skipped. Exit status 1 when a check does not hold or a proof fails.
"""

import argparse
from pathlib import Path

from codegen.protocol_source import protocol_source
from controllers.loading import load_scheduled
from records.board import BOARDS
from records.errors import BadInput
from records.files import write_atomic
from records.protocol import protocol_of
from records.verification import verification_text
from twinlaw.cli import console, options
from twinlaw.pages.run.checks import verification_rows
from twinlaw.workflows.chain.building import build_image, generate_sources
from twinlaw.workflows.chain.designing import demand_table_of, table_poles
from twinlaw.workflows.chain.proving import with_proofs
from twinlaw.workflows.chain.verifying import STEPS, Built, demand, motion_of, recorded_replay, verify_table
from twinlaw.workflows.reading import load_bound
from verification.proofs import Subject


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --table, --arithmetic, --chip, --log, --steps, --proofs, --all, --out, --json."""
    options.plant(parser)
    options.table(parser)
    options.arithmetic(parser)
    options.chip(parser)
    parser.add_argument(
        "--log", type=Path, action="append", default=[], metavar="LOG.csv", help="replay it too; may be repeated"
    )
    parser.add_argument("--steps", type=options.count, default=STEPS, help="compared at least; default: %(default)s")
    parser.add_argument("--proofs", action="store_true", help="run the proofs as well")
    parser.add_argument("--all", action="store_true", help="with --proofs: every mutant, not a sample of them")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Check, write, tell, and fail where a check does not hold."""
    board = BOARDS[chosen.chip]
    if chosen.proofs and not board.is_emulated:
        remedy = "leave --chip out: all other proofs are of the C, which is the same for every chip"
        raise BadInput("--proofs", "verify", board.chip, "an emulated chip, whose cycles are counted", remedy)
    if chosen.all and not chosen.proofs:
        raise BadInput("--all", "verify", "no --proofs", "both, as --all is of the proofs' mutants", "add --proofs")
    table = load_scheduled(chosen.table, "bounds, poles and proofs")
    bound = load_bound(chosen.plant)
    demand_table_of(bound, table, str(chosen.table))
    recorded = [recorded_replay(path, table, bound, chosen.arithmetic) for path in chosen.log]
    poles = table_poles(bound, table, chosen.arithmetic)
    law = generate_sources(table, chosen.arithmetic, chosen.out / "generated")
    image = build_image(table, law, chosen.out, board)
    built = Built(chosen.arithmetic, law, image)
    verification = verify_table(bound, table, poles, built, [replay for replay, _ in recorded], chosen.steps)
    if chosen.proofs:
        motion = motion_of(bound, table)
        generated = {**law, **protocol_source(protocol_of(table.loops))}
        subject = Subject(table, generated, image.elf, motion, chosen.arithmetic, chosen.all)
        verification = with_proofs(verification, subject)
    text = verification_text(verification)
    write_atomic(chosen.out / "verification.json", text)
    print(text if chosen.json else console.table(verification_rows(verification)))
    if image is not None and not board.is_emulated and not chosen.json:
        print(f"- {board.chip}: its law ran on the core alone; cycles, peripherals and line are not emulated")
    if not chosen.json:
        console.notes([said for _, each in recorded for said in each])
    demand(verification)
    return 0
