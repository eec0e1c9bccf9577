"""Write the firmware image into a board: through an ST-LINK (OpenOCD), or through the chip's serial boot loader.

Without --port the ST-LINK is used and DIR/firmware.elf written; with --port the boot loader (stm32flash) and DIR/firmware.bin,
which the chip must have started (docs/hardware.md). Both verify what they wrote and start it. --port emulated tries the second way
on an emulated chip, from its boot loader to the started firmware's answer. --arithmetic refuses an image of the other one before
anything is written. Exit status 1 when writing had begun and failed.
"""

import argparse
import json
from pathlib import Path

from records.errors import BadInput
from rig.link.client import asked_identity
from rig.programming.emulated_flash import flash_emulated
from rig.programming.flash import flash_through_boot_loader, flash_through_st_link
from toolchain.elf import flash_content, image_board
from twinlaw.cli import console, options
from twinlaw.workflows.chain.boards import board_url, demand_image


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--port, --sequence, --arithmetic, --out, --json."""
    parser.add_argument(
        "--port",
        type=options.port_name,
        help="serial port of the boot loader, or `emulated`; without it the ST-LINK is used",
    )
    parser.add_argument(
        "--sequence",
        metavar="DTR_RTS",
        help="how DTR and RTS start the boot loader, and behind a colon the firmware, as stm32flash's -i takes it: --sequence=-dtr,rts:dtr",
    )
    options.demanded_arithmetic(parser)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Choose the way, program, and say what was written."""
    if chosen.sequence is not None and chosen.port in (None, "emulated"):
        got, remedy = f"--port {chosen.port}" if chosen.port else "no --port", "give the port, or leave it out"
        raise BadInput("--sequence", "flash", got, "the serial port whose lines it moves", remedy)
    image = chosen.out / ("firmware.bin" if chosen.port else "firmware.elf")
    demand_image(image)
    _demand_chip(chosen.out / "firmware.elf")
    if chosen.arithmetic is not None:
        _demand_arithmetic(image, chosen.arithmetic)
    if chosen.port == "emulated":
        with console.stage(f"writing {image} into an emulated chip"):
            identity = flash_emulated(image)
        told = f"{image} written, verified and started on an emulated chip, where it answers:\n"
        told += f"table {identity.table_digest[:16]}, {identity.arithmetic}, firmware {identity.firmware_version}"
        answer = {"table_digest": identity.table_digest, "arithmetic": identity.arithmetic}
    else:
        with console.stage(f"writing {image}"):
            if chosen.port:
                flash_through_boot_loader(image, chosen.port, chosen.sequence)
            else:
                flash_through_st_link(image)
        told = f"{image} written, verified and started; check the board with `twinlaw validate --port PORT`"
        answer = {}
    print(json.dumps({"image": str(image), "port": chosen.port, "written": True, **answer}) if chosen.json else told)
    return 0


def _demand_chip(elf: Path) -> None:
    """Raise BadInput for an image of a chip whose ways into the flash have not been tried on an emulated one."""
    board = image_board(elf.read_bytes()) if elf.is_file() else None
    if board is not None and not board.is_emulated:
        remedy = (
            f"nothing was written; `openocd -f {board.openocd_config}` has `program {elf} verify reset exit` for it"
        )
        raise BadInput("firmware image", str(elf), f"one for the {board.chip}", "a chip that is emulated", remedy)


def _demand_arithmetic(image: Path, arithmetic: str) -> None:
    """Raise BadInput unless the image says, on the emulated board, that it computes in this arithmetic; a .bin must be that of its .elf."""
    elf = image.with_suffix(".elf")
    identity = asked_identity(board_url("emulated", elf))
    if identity.arithmetic != arithmetic:
        remedy = f"nothing was written; build it with `twinlaw build --arithmetic {arithmetic}`"
        raise BadInput("arithmetic", str(image), identity.arithmetic, arithmetic, remedy)
    if image != elf and flash_content(elf.read_bytes(), str(elf)) != image.read_bytes():
        remedy = "nothing was written; build both again with `twinlaw build`"
        raise BadInput(
            "firmware image", str(image), "another one than firmware.elf", "the two files of one build", remedy
        )
