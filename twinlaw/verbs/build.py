"""Build the firmware image of a controller table for the STM32G071 and print what it takes of flash and RAM.

Writes DIR/generated/, DIR/firmware.elf, DIR/firmware.bin and DIR/firmware.a2l (ASAP2: signals and tables, for calibration tools).
An image that does not fit is a link error (exit 2).
"""

import argparse
import json
from dataclasses import asdict

from records.files import write_atomic
from records.table import load_table
from twinlaw import console, options, summary
from twinlaw.exchange import image_a2l
from twinlaw.stages import build_image, generate_sources


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--table, --arithmetic, --out, --json."""
    options.table(parser)
    options.arithmetic(parser)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Generate, compile, link and tell the sizes."""
    table = load_table(chosen.table)
    texts = generate_sources(table, chosen.arithmetic, chosen.out / "generated")
    image = build_image(texts, chosen.out)
    write_atomic(chosen.out / "firmware.a2l", image_a2l(table, chosen.arithmetic, image.elf))
    if chosen.json:
        facts = {kind: str(chosen.out / f"firmware.{kind}") for kind in ("elf", "bin", "a2l")}
        print(json.dumps({**facts, "table_digest": table.digest, **asdict(image.sizes)}))
    else:
        print(console.table(summary.size_rows(image.sizes), ("memory", "bytes", "of")))
    return 0
