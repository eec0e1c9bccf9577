"""Compiled kernels: a model's equations in C with the fixed loops of sim/kernel/c, single and side by side."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.kernel.generate import model_header
from sim.kernel.sincos import sincos_header
from sim.model import Model
from toolchain.host import FAST_FLAGS, CText, Source, build_shared, load_shared

C_DIR = Path(__file__).parent / "c"
# Three libraries: most models never fly side by side, and most that fly are asked for no derivative, half of the compiler's time.
SINGLE = ("single.c", "events.c")
SENSITIVITY = ("sensitivity.c", "events.c")
BATCH = ("batch.c", "events.c")
# One run has nothing to lay side by side: a compiler that looks for that and more takes twice as long, and what it makes is no faster.
ONE_RUN_FLAGS = ("-O1", "-fno-vectorize", "-fno-slp-vectorize")
# Inside each caller short equations run faster; longer ones than this run no faster and take the compiler three times as long.
LONG_EQUATIONS = 16_000  # characters of C
EQUATIONS_ONCE_FLAGS = ("-DEQUATIONS_ONCE",)
MANY_RUNS_FLAGS = ("-DMANY_RUNS",)
HEADERS = ("request.h", "law_table.h", "sensitivity.h", "exports.h")
BATCH_LANES = 8
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Kernel:
    """A model's compiled functions: `lib` as declared in sim/kernel/c/exports.h, called through `ffi`.

    All numbers are float64, in the model's order: states, inputs, outputs, parameters, axes.
    """

    model: Model
    ffi: Any
    lib: Any

    @property
    def batch(self) -> Any:
        """The library with `run_batch`, compiled when it is first asked for; raises BadInput when the compiler refuses."""
        return _further(self, "batch", BATCH)

    @property
    def sensitivity(self) -> Any:
        """The library with `sensitivity_run`, compiled when it is first asked for; raises BadInput when the compiler refuses."""
        return _further(self, "sensitivity", SENSITIVITY)

    @property
    def constants(self) -> int:
        """Length of the array of constants."""
        return int(self.lib.constants_count())

    def pointer(self, array: NDArray[Any] | None) -> Any:
        """The C address of a contiguous array of any shape, which must outlive its use; NULL for None."""
        return self.ffi.NULL if array is None else self.ffi.cast("void *", array.ctypes.data)


@lru_cache(maxsize=64)
def kernel(model: Model) -> Kernel:
    """The kernel of `model`, compiled once for each content; raises BadInput when the compiler refuses."""
    ffi, lib = load_shared(_declarations(), _built(model, "kernel", SINGLE))
    return Kernel(model, ffi, lib)


@lru_cache(maxsize=128)
def _further(single: Kernel, what: str, files: tuple[str, ...]) -> Any:
    return single.ffi.dlopen(str(_built(single.model, what, files)))


def _built(model: Model, name: str, files: tuple[str, ...]) -> Path:
    sources: list[Source] = [
        CText("model.h", _header(model)),
        CText("sincos_coefficients.h", sincos_header()),
        *(C_DIR / file for file in files),
    ]
    own = MANY_RUNS_FLAGS if files is BATCH else ONE_RUN_FLAGS
    if files is SINGLE and len(_header(model)) > LONG_EQUATIONS:
        own = (*own, *EQUATIONS_ONCE_FLAGS)
    flags = (*FAST_FLAGS, *own, f"-DBATCH_LANES={BATCH_LANES}")
    return build_shared(name, sources, include_dirs=[C_DIR], flags=flags, of=model.name)


@lru_cache(maxsize=64)
def _header(model: Model) -> str:
    return model_header(model)


def _declarations() -> str:
    """What cffi must know, from the headers themselves: it reads C without the preprocessor."""
    lines = [line for name in HEADERS for line in (C_DIR / name).read_text(encoding="utf-8").splitlines()]
    return "\n".join(line for line in lines if not line.startswith("#"))
