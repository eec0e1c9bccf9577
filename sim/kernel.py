"""Compiled kernels: a model's equations in C with the fixed loops of sim/c, single and side by side."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.generate import model_header
from sim.model import Model
from sim.sincos import sincos_header
from toolchain.host import FAST_FLAGS, CText, Source, build_shared, load_shared

C_DIR = Path(__file__).parent / "c"
SOURCES = ("single.c", "batch.c", "events.c", "sensitivity.c")
HEADERS = ("request.h", "law_table.h", "sensitivity.h", "exports.h")
BATCH_LANES = 8
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Kernel:
    """A model's compiled functions: `lib` as declared in sim/c/exports.h, called through `ffi`."""

    model: Model
    ffi: Any
    lib: Any

    @property
    def constants(self) -> int:
        """Length of the array of constants."""
        return int(self.lib.constants_count())

    def pointer(self, array: NDArray[Any] | None) -> Any:
        """The C address of a contiguous array; NULL for None."""
        return self.ffi.NULL if array is None else self.ffi.cast("void *", array.ctypes.data)


@lru_cache(maxsize=64)
def kernel(model: Model) -> Kernel:
    """The kernel of `model`, compiled once for each content; raises BadInput when the compiler refuses."""
    sources: list[Source] = [
        CText("model.h", model_header(model)),
        CText("sincos_coefficients.h", sincos_header()),
        *(C_DIR / name for name in SOURCES),
    ]
    flags = (*FAST_FLAGS, f"-DBATCH_LANES={BATCH_LANES}")
    path = build_shared(f"kernel-{model.name}", sources, include_dirs=[C_DIR], flags=flags)
    ffi, lib = load_shared(_declarations(), path)
    return Kernel(model, ffi, lib)


def _declarations() -> str:
    """What cffi must know, from the headers themselves: it reads C without the preprocessor."""
    lines = [line for name in HEADERS for line in (C_DIR / name).read_text(encoding="utf-8").splitlines()]
    return "\n".join(line for line in lines if not line.startswith("#"))
