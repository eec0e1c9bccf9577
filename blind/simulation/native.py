"""Compiled code, and arrays and settings on their way into it."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind.effects.effect import Settings
from toolchain.host import build_shared, load_shared

OPENING = Lock()

# No -march: the same seed must give the same bytes on another machine of this kind.
FLAGS = (
    "-O3",
    "-std=c11",
    "-D_GNU_SOURCE",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-sanitize=undefined",
    "-Wall",
    "-Wextra",
    "-Werror",
)


def simulation(name: str, header: Path, sources: Sequence[str]) -> tuple[Any, Any]:
    """(ffi, lib) of a rig's simulation, compiled from `sources` beside their header.

    Opened once for all threads: a structure made with one ffi is none for another.
    """
    with OPENING:
        return _opened(name, header, tuple(sources))


@cache
def _opened(name: str, header: Path, sources: tuple[str, ...]) -> tuple[Any, Any]:
    folder = header.parent
    path = build_shared(name, [folder / source for source in sources], include_dirs=(folder,), flags=FLAGS)
    return load_shared(header.read_text(encoding="utf-8"), path)


def pointer(ffi: Any, array: NDArray[np.float64]) -> Any:
    """The address of an array of doubles; the array must outlive it."""
    return ffi.cast("double *", array.ctypes.data)


def set_fields(struct: Any, settings: Settings) -> None:
    """Write (field, index, -1 for a number) -> value into a C structure."""
    for (field, index), value in settings.items():
        if index < 0:
            setattr(struct, field, value)
        else:
            getattr(struct, field)[index] = value
