"""Write the firmware image into a board: through an ST-LINK (OpenOCD), or through the chip's serial boot loader.

Without --port the ST-LINK is used and DIR/firmware.elf written; with --port the boot loader and DIR/firmware.bin, which
the chip must have started (docs/hardware.md). Both verify what they wrote and start it.
"""

import argparse
import json

from records.errors import BadInput
from rig.flash import boot_loader_command, openocd_command, run_flash
from twinlaw import console, options


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--port, --out, --json."""
    parser.add_argument("--port", help="serial port of the boot loader; without it the ST-LINK is used")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Choose the way, program, and say what was written."""
    image = chosen.out / ("firmware.bin" if chosen.port else "firmware.elf")
    if not image.is_file():
        raise BadInput(
            "firmware image", str(image), "no such file", "an image", "build it with `twinlaw build` or `twinlaw run`"
        )
    command = boot_loader_command(image, chosen.port) if chosen.port else openocd_command(image)
    with console.stage(f"writing {image}"):
        run_flash(command)
    if chosen.json:
        print(json.dumps({"image": str(image), "port": chosen.port, "written": True}))
        return 0
    print(f"{image} written, verified and started; check the board with `twinlaw validate --port PORT`")
    return 0
