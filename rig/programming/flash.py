"""Programming a board: OpenOCD through the ST-LINK, or stm32flash through the chip's serial boot loader (AN3155)."""

import os
import re
import shutil
import struct
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from records.board import STM32G071, Board
from records.errors import BadInput, VerificationFailed
from records.pages import page
from rig.link.port import claimed

_PSEUDO_TERMINALS = "/dev/pts/"
_STARTED = "Starting execution at address 0x{:08x}... done"
_COMPLAINT = re.compile(r"error|fail|nack|can't|cannot|unknown|unsupported|timeout", re.IGNORECASE)
_MOST_LINES = 3
_ERASE_REFUSED = re.compile(r"NACK.*0x44.*Failed to erase memory", re.DOTALL)
_READ_REFUSED = re.compile(r"NACK.*Failed to read memory", re.DOTALL)
_PROTECTED = re.compile(r"protect|locked|RDP", re.IGNORECASE)
_OTHER_WAY = {
    "stm32flash": "through an ST-LINK, without --port, for which openocd is needed",
    "openocd": "through the boot loader, with --port PORT, for which stm32flash is needed",
}
_FLASH_AGAIN = "the chip may hold a part of the image: leave the motors without supply and flash again"


def openocd_command(elf: Path, board: Board = STM32G071) -> list[str]:
    """Program, verify and start `elf` through an ST-LINK."""
    return ["openocd", "-f", board.openocd_config, "-c", f"program {{{elf}}} verify reset exit"]


def identify_command(port: str, sequence: str | None = None) -> list[str]:
    """Ask the boot loader which chip it is in."""
    return [*_stm32flash(port, sequence), port]


def read_command(port: str, sequence: str | None = None, board: Board = STM32G071) -> list[str]:
    """Read the first word of the flash, which a protected chip refuses."""
    return [*_stm32flash(port, sequence), "-r", os.devnull, "-S", f"0x{board.flash.start:08x}:4", port]


def boot_loader_command(binary: Path, port: str, sequence: str | None = None, board: Board = STM32G071) -> list[str]:
    """Write, verify and start `binary` through the serial boot loader."""
    return [*_stm32flash(port, sequence), "-w", str(binary), "-v", "-g", f"0x{board.flash.start:08x}", port]


def _stm32flash(port: str, sequence: str | None) -> list[str]:
    return ["stm32flash", "-m", line_mode(port), *([] if sequence is None else ["-i", sequence])]


def line_mode(port: str) -> str:
    """The boot loader's line has even parity (AN3155, section 2); a pseudo-terminal carries none, and refuses to be asked for it."""
    return "8n1" if str(Path(port).resolve()).startswith(_PSEUDO_TERMINALS) else "8e1"


def flash_through_st_link(elf: Path, board: Board = STM32G071) -> None:
    """Program, verify and start through an ST-LINK.

    Raises BadInput when the tool or the ST-LINK is not there, VerificationFailed when programming had begun and failed.
    """
    command = openocd_command(elf, board)
    with _interrupted(_FLASH_AGAIN):
        done = _run(command)
    if done.returncode == 0:
        return
    if "** Programming Started **" in done.stdout + done.stderr:
        raise _not_programmed(command[0], done)
    remedy = f"check the cable and the board's supply; {page('hardware.md')}"
    if _PROTECTED.search(done.stdout + done.stderr):
        unlock = f'openocd -f {board.openocd_config} -c "init; reset halt; stm32l4x unlock 0; reset halt; shutdown"'
        remedy = f"a protected chip is freed by `{unlock}`, which ERASES THE WHOLE FLASH; then cut its supply once"
    raise _refused(command[0], done, "an ST-LINK with a board behind it", remedy)


def flash_through_boot_loader(binary: Path, port: str, sequence: str | None = None, board: Board = STM32G071) -> None:
    """Ask which chip answers, then write, verify and start; `sequence` of DTR and RTS is stm32flash's own (its option -i).

    Raises BadInput when the tool or the boot loader is not there, the port is in use, or the chip is another one or protected, before
    anything is erased; VerificationFailed when writing had begun and failed.
    """
    _demand_image(binary, board)
    with claimed(port):
        with _interrupted("nothing was written"):
            asked = _run(identify_command(port, sequence))
        _demand_chip(asked, port, board)
        with _interrupted(_FLASH_AGAIN):
            written = _run(boot_loader_command(binary, port, sequence, board))
        if _ERASE_REFUSED.search(written.stderr):
            _demand_readable(_run(read_command(port, sequence, board)), port)
    if written.returncode != 0:
        raise _not_programmed(
            port, written, f"; write-protected pages are freed by `stm32flash -u {port}`, which erases nothing"
        )
    if _STARTED.format(board.flash.start) not in written.stdout:  # of a refused start the tool tells, but does not fail
        got, expected = _complaint(written), "the image started"
        raise VerificationFailed(
            f"{port}: start: got {got}, expected {expected}; it is written and verified: reset the board by hand"
        )


def _demand_chip(asked: subprocess.CompletedProcess[str], port: str, board: Board) -> None:
    """Raise BadInput unless the boot loader of this chip has answered."""
    if asked.returncode != 0:
        raise _refused(
            port,
            asked,
            "the chip's boot loader to answer",
            f"how the chip starts its boot loader is in {page('hardware.md')}",
        )
    chip_id = re.search(r"Device ID\s*:\s*0x([0-9a-fA-F]+)", asked.stdout)
    if chip_id is None or int(chip_id[1], 16) != board.boot_loader_id:
        raise BadInput(
            what="chip",
            where=port,
            got=f"device id 0x{chip_id[1]}" if chip_id else "no device id",
            expected=f"0x{board.boot_loader_id:04x} ({board.chip})",
            remedy="nothing was written; give the port of the right board as --port",
        )


def _demand_readable(read: subprocess.CompletedProcess[str], port: str) -> None:
    """Raise BadInput where a chip that refused to be erased refuses to be read as well: it is protected (AN3155, sections 3.4 and 3.8)."""
    if _READ_REFUSED.search(read.stderr):
        raise BadInput(
            what="chip",
            where=port,
            got=f"a read-out protected chip ({_complaint(read)})",
            expected="one without read or write protection",
            remedy=f"nothing was written; `stm32flash -k {port}` lifts the protection AND ERASES THE WHOLE FLASH (level 2 stays for ever)",
        )


def _demand_image(binary: Path, board: Board) -> None:
    """Raise BadInput for what this chip could not start: the vectors of a Cortex-M stand first, within its memories."""
    content = binary.read_bytes()
    stack, start = struct.unpack("<II", content[:8].ljust(8, b"\xff"))
    flash, ram = board.flash, board.ram
    fits = len(content) <= flash.size_bytes and ram.start < stack <= ram.start + board.largest_ram_bytes
    if not (fits and start & 1 and flash.start <= start < flash.start + len(content)):
        raise BadInput(
            what="firmware image",
            where=str(binary),
            got=f"{len(content)} bytes that begin with {content[:8].hex(' ') or 'nothing'}",
            expected=f"an image of {flash.size_bytes} bytes at most that begins with its stack and its start",
            remedy="build it with `twinlaw build` or `twinlaw run`",
        )


def _run(command: Sequence[str]) -> subprocess.CompletedProcess[str]:
    """Run a programming command; raises BadInput when the tool is not installed."""
    tool = command[0]
    if shutil.which(tool) is None:
        raise BadInput(
            what="programming tool",
            where="flash",
            got=f"no {tool} on this computer",
            expected=f"{tool} in the search path",
            remedy=f"install it (Debian, Ubuntu: sudo apt install {tool}), or flash {_OTHER_WAY[tool]}",
        )
    return subprocess.run(list(command), capture_output=True, text=True, errors="replace", check=False)


@contextmanager
def _interrupted(told: str) -> Iterator[None]:
    """Ctrl-C leaves word of what the chip may hold then."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(told) from None


def _refused(where: str, done: subprocess.CompletedProcess[str], expected: str, remedy: str) -> BadInput:
    return BadInput("programming", where, _complaint(done), expected, f"nothing was written; {remedy}")


def _not_programmed(where: str, done: subprocess.CompletedProcess[str], further: str = "") -> VerificationFailed:
    got = _complaint(done)
    return VerificationFailed(
        f"{where}: programming: got {got}, expected the image written, verified and started; {_FLASH_AGAIN}{further}"
    )


def _complaint(done: subprocess.CompletedProcess[str]) -> str:
    """What the tool itself gives as its reason: its last lines that complain, else its last line."""
    lines = [line.strip(" *") for line in (done.stdout + "\n" + done.stderr).splitlines() if line.strip()]
    complaints = [line for line in lines if _COMPLAINT.search(line)]
    return "; ".join((complaints or lines)[-_MOST_LINES:]) or f"exit status {done.returncode}"
