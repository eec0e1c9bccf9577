"""Validate a board behind a serial port: its table, its self-test, replayed steps bit by bit, and a flight in its loop.

--port emulated (the default) runs DIR/firmware.elf on the emulated board; a device such as /dev/ttyACM0 is a real one, whose rig
stays still in host-in-the-loop mode as long as its power is off. Writes DIR/validation.json and DIR/validation.csv + .toml.
Exit status 1 when a check does not hold.
"""

import argparse
import json

from controllers import loading
from records.errors import VerificationFailed
from records.files import write_atomic
from records.log import save_log
from records.verification import validation_text
from sim.tracking import left
from sim.wiring import wiring
from twinlaw.cli import console, options
from twinlaw.pages.run.checks import validation_rows
from twinlaw.pages.run.tracking import TRACKING_HEADING, left_sentence, tracking_facts, tracking_rows
from twinlaw.workflows.chain.boards import board_url, connected, fly_board, validate_board
from twinlaw.workflows.reading import load_bound


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--port, --dtr, --rts, --plant, --table, --arithmetic, --steps, --out, --json."""
    options.port(parser)
    options.plant(parser)
    options.table(parser)
    options.arithmetic(parser)
    parser.add_argument("--steps", type=options.count, default=10_000, help="replayed at least; default: %(default)s")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Ask, replay, fly, write, and fail where a check does not hold."""
    lines = options.modem_lines(chosen)
    bound, table = load_bound(chosen.plant), loading.load(chosen.table)[1]
    wiring(bound, table.loops)  # now, and not after the steps that come before the flight
    url = board_url(chosen.port, chosen.out / "firmware.elf")
    with connected(table, url, chosen.arithmetic, lines) as client:
        validation = validate_board(client, table, chosen.port, chosen.steps)
        text = validation_text(validation)
        if not validation.passed:
            write_atomic(chosen.out / "validation.json", text)
            raise VerificationFailed("; ".join(validation.failures))
        for note in validation.notes:  # now: a line that waits makes a flight of minutes
            console.remark(note)
        flight = fly_board(bound, table, client)
    # Only now: a board that is lost in its flight has not been validated.
    write_atomic(chosen.out / "validation.json", text)
    save_log(chosen.out / "validation.csv", flight.log)
    if chosen.json:
        flown = {"left": list(left(flight.tracking)), **tracking_facts(flight.tracking)}
        print(json.dumps(json.loads(text) | flown))
        return 0
    if gone := left_sentence(flight.tracking):
        print(f"{gone}\n")
    print(console.table(validation_rows(validation)))
    print()
    print(console.table(tracking_rows(flight.tracking), TRACKING_HEADING))
    return 0
