"""Write the firmware image into a board: through an ST-LINK (OpenOCD), or through the chip's serial boot loader.

Without --port the ST-LINK is used and DIR/firmware.elf written; with --port the boot loader (stm32flash) and DIR/firmware.bin,
which the chip must have started (docs/hardware.md). Both verify what they wrote and start it. --port emulated tries the second way
on an emulated chip, from its boot loader to the started firmware's answer. Exit status 1 when writing had begun and failed.
"""

import argparse
import json

from records.errors import BadInput
from rig.emulated_flash import flash_emulated
from rig.flash import flash_through_boot_loader, flash_through_st_link
from twinlaw import console, options


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--port, --out, --json."""
    parser.add_argument("--port", help="serial port of the boot loader, or `emulated`; without it the ST-LINK is used")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Choose the way, program, and say what was written."""
    image = chosen.out / ("firmware.bin" if chosen.port else "firmware.elf")
    if not image.is_file():
        raise BadInput(
            "firmware image", str(image), "no such file", "an image", "build it with `twinlaw build` or `twinlaw run`"
        )
    if chosen.port == "emulated":
        with console.stage(f"writing {image} into an emulated chip"):
            identity = flash_emulated(image)
        told = f"{image} written, verified and started on an emulated chip, where it answers:\n"
        told += f"table {identity.table_digest[:16]}, {identity.arithmetic}, firmware {identity.firmware_version}"
        answer = {"table_digest": identity.table_digest, "arithmetic": identity.arithmetic}
    else:
        with console.stage(f"writing {image}"):
            if chosen.port:
                flash_through_boot_loader(image, chosen.port)
            else:
                flash_through_st_link(image)
        told = f"{image} written, verified and started; check the board with `twinlaw validate --port PORT`"
        answer = {}
    print(json.dumps({"image": str(image), "port": chosen.port, "written": True, **answer}) if chosen.json else told)
    return 0
