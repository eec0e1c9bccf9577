"""The serial boot loader's way into a board, tried without one."""

from pathlib import Path

from rig.emulator.pty_port import PtyBootLoader
from rig.link.client import asked_identity
from rig.link.replies import Identity
from rig.programming.flash import flash_through_boot_loader


def flash_emulated(binary: Path) -> Identity:
    """Write `binary` into an emulated chip behind a pseudo-terminal, start it, and return what it says it is.

    Raises BadInput and VerificationFailed as `flash_through_boot_loader` does, and BadInput when the started image does not answer.
    """
    with PtyBootLoader() as chip:
        flash_through_boot_loader(binary, chip.path)
        return asked_identity(chip.path)
