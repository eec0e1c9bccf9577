"""Build the firmware image of a controller table for the STM32G071 and print what it takes of flash and RAM.

Writes DIR/generated/, DIR/firmware.elf and DIR/firmware.bin. An image that does not fit is a link error (exit 2).
"""

import argparse
import json
from dataclasses import asdict

from records.table import load_table
from twinlaw import console, options, summary
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
    if chosen.json:
        facts = {"elf": str(chosen.out / "firmware.elf"), "bin": str(chosen.out / "firmware.bin")}
        print(json.dumps({**facts, "table_digest": table.digest, **asdict(image.sizes)}))
    else:
        print(console.table(summary.size_rows(image.sizes), ("memory", "bytes", "of")))
    return 0
