"""Images on the emulated board, behind its serial line."""

from collections.abc import Mapping
from pathlib import Path

from records.loops import LOOPS, Loop
from rig.programming.image import build_firmware


def emulated_url(law: Mapping[str, str], folder: Path, loops: tuple[Loop, ...] = LOOPS) -> str:
    """Where the emulated board answers with the image around the texts of this law, built into `folder`."""
    build_firmware(law, folder, loops=loops)
    return f"emulated://{folder / 'firmware.elf'}"
