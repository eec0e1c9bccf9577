"""Programming a board: OpenOCD through the ST-LINK, or stm32flash through the chip's serial boot loader (AN3155)."""

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from records.errors import BadInput

FLASH_START = 0x08000000
_LAST_LINES = 3


def openocd_command(elf: Path, *, board: str = "board/st_nucleo_g0.cfg") -> list[str]:
    """Program, verify and start `elf` through an ST-LINK."""
    return ["openocd", "-f", board, "-c", f"program {{{elf}}} verify reset exit"]


def boot_loader_command(binary: Path, port: str, *, line_mode: str = "8e1") -> list[str]:
    """Write, verify and start `binary` through the serial boot loader; the chip's line is 8e1, a pty's 8n1."""
    return ["stm32flash", "-m", line_mode, "-w", str(binary), "-v", "-g", f"0x{FLASH_START:08x}", port]


def run_flash(command: Sequence[str]) -> str:
    """Run a programming command and return what it said.

    Raises BadInput when the tool is not installed, or fails: its own last lines are in the message.
    """
    tool = command[0]
    if shutil.which(tool) is None:
        raise BadInput(
            what="programming tool",
            where="flash",
            got=f"no {tool} on this computer",
            expected=f"{tool} in the search path",
            remedy=f"install it (Debian: apt install {tool}), or use the other way to flash",
        )
    done = subprocess.run(list(command), capture_output=True, text=True, check=False)
    said = (done.stdout + done.stderr).strip()
    if done.returncode != 0:
        last = "; ".join(line.strip() for line in said.splitlines()[-_LAST_LINES:])
        raise BadInput(
            what="programming",
            where=" ".join(command),
            got=last or f"exit status {done.returncode}",
            expected="the image written and verified",
            remedy="check cable and supply; how the chip starts its serial boot loader is in docs/hardware.md",
        )
    return said
