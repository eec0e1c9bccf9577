"""The whole chain: design, generate, build, verify, and fly the firmware image on the emulated board.

Leaves in DIR: controller.json, generated/, firmware.elf, firmware.bin, run.csv + run.toml, verification.json, report.html.
Loops other than the helicopter's have pins where the plant file's section [board] names them; without, they fly with the host in the loop.
"""

import argparse
import json
from dataclasses import asdict, replace

from records.files import remove_all, write_atomic
from records.log import save_log
from records.quality import quality_facts
from records.table import table_text
from records.verification import Verification, verification_text
from rig.programming.image import FirmwareImage
from sim.tracking import left
from twinlaw.cli import console, options
from twinlaw.pages.page import page_text
from twinlaw.pages.quality import quality_told
from twinlaw.pages.run.checks import size_rows, verification_rows
from twinlaw.pages.run.design import design_facts, design_heading, design_rows
from twinlaw.pages.run.flight import ChainFlight
from twinlaw.pages.run.report import run_page
from twinlaw.pages.run.tracking import TRACKING_HEADING, flight_quality, left_sentence, tracking_facts, tracking_rows
from twinlaw.workflows.chain.boards import board_url, connected, fly_board
from twinlaw.workflows.chain.building import build_image, generate_sources
from twinlaw.workflows.chain.causes import cause
from twinlaw.workflows.chain.designing import Designed, design_controller, poles_of, roll_off_trade
from twinlaw.workflows.chain.verifying import Built, demand, verify_table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --arithmetic, --out, --json."""
    options.plant(parser)
    options.arithmetic(parser)
    options.out(parser)
    options.as_json(parser)


_LATER = ("verification.json", "run.csv", "run.toml", "report.html", "firmware.elf", "firmware.bin")


def _flown(designed: Designed, chosen: argparse.Namespace) -> ChainFlight:
    """The flight of the image on the emulated board."""
    with connected(designed.table, board_url("emulated", chosen.out / "firmware.elf"), chosen.arithmetic) as client:
        return fly_board(designed.bound, designed.table, client)


def run(chosen: argparse.Namespace) -> int:
    """Every stage in turn; each leaves its files as soon as it is done."""
    out = chosen.out
    designed = design_controller(chosen.plant, chosen.arithmetic)
    # Whatever stops this run, no verdict or flight of an earlier one is to lie beside the new table.
    remove_all(out / name for name in _LATER)
    write_atomic(out / "controller.json", table_text(designed.table))
    law = generate_sources(designed.table, chosen.arithmetic, out / "generated")
    image = build_image(designed.table, law, out)
    built = Built(chosen.arithmetic, law, image)
    verification = verify_table(designed.bound, designed.table, poles_of(designed.report), built)
    write_atomic(out / "verification.json", verification_text(verification))
    demand(verification)
    flight = _flown(designed, chosen)
    save_log(out / "run.csv", flight.log)
    flight = replace(flight, cause=cause(designed.bound, designed.table, chosen.arithmetic, flight.tracking))
    name, trade = designed.bound.plant.name, roll_off_trade(designed)
    page = run_page(name, designed.report, verification, image.sizes, flight, trade)
    write_atomic(out / "report.html", page_text(page))
    _tell(designed, verification, image, flight, chosen)
    return 0


def _tell(
    designed: Designed,
    verification: Verification,
    image: FirmwareImage,
    flight: ChainFlight,
    chosen: argparse.Namespace,
) -> None:
    """Each stage's figures, for a program where it asks."""
    out = chosen.out
    if chosen.json:
        facts = {"out": str(out), "table_digest": designed.table.digest, "passed": verification.passed}
        facts |= {"design": design_facts(designed.report), "verification": json.loads(verification_text(verification))}
        facts |= {"left": list(left(flight.tracking)), "cause": flight.cause, **tracking_facts(flight.tracking)}
        facts |= {"quality": quality_facts(flight_quality(flight.tracking)), "sizes": asdict(image.sizes)}
        print(json.dumps(facts))
        return
    if gone := left_sentence(flight.tracking):
        print(f"{gone}\n")
    print(console.table(design_rows(designed.report), design_heading(designed.report)))
    print()
    print(console.table(verification_rows(verification), ("verification", "figures", "")))
    print()
    print(console.table(tracking_rows(flight.tracking), TRACKING_HEADING))
    print()
    if flight.cause:
        print(f"{quality_told(flight_quality(flight.tracking), flight.cause, gone)}\n")
    print(console.table(size_rows(image.sizes), ("memory", "bytes", "of")))
    print(f"\n{out / 'report.html'}  table {designed.table.digest[:16]}")
