"""The compiled simulator: its C interface as cffi reads it, and its build."""

from functools import cache
from pathlib import Path
from typing import Any

from cffi import FFI

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


@cache
def library() -> tuple[FFI, Any]:
    """(ffi, lib) of the simulator, compiled at the first use on a machine and kept in the cache."""
    sources = [source for folder in C_DIRS for source in sorted(folder.glob("*.c"))]
    path = build_shared("emulator", sources, include_dirs=C_DIRS, flags=FLAGS)
    return load_shared(declarations(HEADER.read_text(encoding="utf-8")), path)
