"""Build the firmware image of a controller table for a chip and print what it takes of flash and RAM.

Writes DIR/generated/, DIR/firmware.elf, DIR/firmware.bin and, for the scheduled law, DIR/firmware.a2l (ASAP2: signals and tables, for
calibration tools).
An image that does not fit is a link error (exit 2).
"""

import argparse
import json
from dataclasses import asdict

from controllers import loading
from records.board import BOARDS
from records.files import remove_all, write_atomic
from records.table import ControllerTable
from twinlaw.cli import console, options
from twinlaw.pages.run.checks import size_rows
from twinlaw.workflows.chain.building import build_image, generate_sources, image_a2l


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--table, --arithmetic, --chip, --out, --json."""
    options.table(parser)
    options.arithmetic(parser)
    options.chip(parser)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Generate, compile, link and tell the sizes."""
    table = loading.load(chosen.table)[1]
    texts = generate_sources(table, chosen.arithmetic, chosen.out / "generated")
    image = build_image(table, texts, chosen.out, BOARDS[chosen.chip])
    kinds = ["elf", "bin"]
    if isinstance(table, ControllerTable):
        write_atomic(chosen.out / "firmware.a2l", image_a2l(table, chosen.arithmetic, image.elf))
        kinds.append("a2l")
    else:
        remove_all([chosen.out / "firmware.a2l"])  # that of an earlier table
    if chosen.json:
        facts = {kind: str(chosen.out / f"firmware.{kind}") for kind in kinds}
        print(json.dumps({**facts, "chip": chosen.chip, "table_digest": table.digest, **asdict(image.sizes)}))
    else:
        print(console.table(size_rows(image.sizes, image.board), ("memory", "bytes", "of")))
    return 0
