"""The compiled simulator of a chip: its C interface as cffi reads it, and its build."""

from functools import cache
from pathlib import Path
from typing import Any

from cffi import FFI

from records.board import STM32G071, Board
from toolchain.host import build_shared, load_shared

FOLDER = Path(__file__).resolve().parent
C_DIRS = tuple(FOLDER / room for room in ("line", "machine", "core", "peripherals", "host"))
HEADER = FOLDER / "host" / "host.h"
# Guaranteed tail calls need an optimising build; the arithmetic is integer only.
FLAGS = ("-O3", "-std=c11", "-Wall", "-Wextra", "-Werror", "-fno-sanitize=undefined", "-fomit-frame-pointer")


def declarations(header: str) -> str:
    """The part of host.h that cffi understands: everything between the includes and the closing guard."""
    kept = [line for line in header.splitlines() if not line.startswith("#")]
    return "typedef struct machine machine;\n" + "\n".join(kept)


def memory_map(chip: Board) -> list[str]:
    """The chip's memories as the C knows them."""
    numbers = {
        "FLASH_BASE": chip.flash.start,
        "FLASH_BYTES": chip.flash.size_bytes,
        "SRAM_BASE": chip.ram.start,
        "SRAM_BYTES": chip.ram.size_bytes,
    }
    return [f"-D{name}=0x{number:x}u" for name, number in numbers.items()]


@cache
def library(chip: Board = STM32G071) -> tuple[FFI, Any]:
    """(ffi, lib) of the simulator of `chip`, compiled at the first use on a machine and kept in the cache."""
    sources = [source for folder in C_DIRS for source in sorted(folder.glob("*.c"))]
    path = build_shared("emulator", sources, include_dirs=C_DIRS, flags=[*FLAGS, *memory_map(chip)])
    return load_shared(declarations(HEADER.read_text(encoding="utf-8")), path)
