"""Compiled code of a rig: what all rigs have alike, the rig's own, and the structure of its effects in one library."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind.effects.effect import SCALAR, Effect, Settings, effects_struct
from toolchain.host import CText, build_shared, load_shared

COMMON_DIR = Path(__file__).resolve().parent / "c"
OF_EVERY_RIG = ("line.c", "stages.c", "predict.c")  # with their headers
COMMON_SOURCES = (*OF_EVERY_RIG, "plant.c", "run.c")
DECLARATIONS = "simulation.h"  # what every C file includes
OPENING = Lock()

# No -march: the same seed must give the same bytes on another machine of this kind. -flto: a step calls across files.
FLAGS = (
    "-O3",
    "-flto",
    "-std=c11",
    "-D_GNU_SOURCE",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-sanitize=undefined",
    "-Wall",
    "-Wextra",
    "-Werror",
)


@dataclass(frozen=True)
class Program:
    """The C of one kind of rig: a name, the folder of its own files (state.h and `sources`), the effects that it can be given."""

    name: str
    folder: Path
    sources: tuple[str, ...]
    effects: tuple[Effect, ...]

    def declarations(self) -> str:
        """Text of simulation.h, for the compiler and for cffi: the plant, the effects' fields, the rig's own state, what a run takes."""
        headers = ("line.h", "plant.h", "stages.h", "run.h", "predict.h")
        line, plant, stages, run, predict = (COMMON_DIR.joinpath(name).read_text(encoding="utf-8") for name in headers)
        own = self.folder.joinpath("state.h").read_text(encoding="utf-8")
        return "\n".join([line, plant, effects_struct(self.effects), "", own, stages, run, predict])


def opened(program: Program) -> tuple[Any, Any]:
    """(ffi, lib) of a program, opened once for all threads: a structure made with one ffi is none for another."""
    with OPENING:
        return _opened(program)


@cache
def _opened(program: Program) -> tuple[Any, Any]:
    text = program.declarations()
    own = [program.folder / source for source in program.sources]
    common = [COMMON_DIR / source for source in COMMON_SOURCES]
    path = build_shared(program.name, [CText(DECLARATIONS, text), *own, *common], flags=FLAGS)
    return load_shared(text, path)


def pointer(ffi: Any, array: NDArray[np.float64]) -> Any:
    """The address of an array of doubles; the array must outlive it."""
    return ffi.cast("double *", array.ctypes.data)


def set_fields(struct: Any, settings: Settings) -> None:
    """Write (field, index, SCALAR for a number) -> value into a C structure."""
    for (field, index), value in settings.items():
        if index == SCALAR:
            setattr(struct, field, value)
        else:
            getattr(struct, field)[index] = value
