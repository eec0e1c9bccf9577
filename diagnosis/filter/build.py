"""The filter of c/, compiled with a plant's equations and loaded."""

from collections.abc import Mapping
from pathlib import Path

from diagnosis.filter.kalman import Filter
from sim.kernel.generate import model_header
from sim.kernel.kernel import C_DIR as SIM_C
from sim.kernel.sincos import sincos_header
from sim.model import Model
from toolchain.host import FAST_FLAGS, CText, build_shared, c_text, load_shared

C_DIR = Path(__file__).parent / "c"
# Read once, when this module is: what is compiled later and how it is called stay of one make, whatever happens to the files.
SOURCES = tuple(c_text(path) for path in (SIM_C / "events.c", C_DIR / "filter.c", C_DIR / "respond.c"))
HEADERS = tuple(c_text(path) for folder in (C_DIR, SIM_C) for path in sorted(folder.glob("*.h")))
DECLARATIONS = next(header.text for header in HEADERS if header.name == "filter.h")
# Unlike the simulation's kernels nothing must be equal to the bit here. Unrolled, and with equations packed two and two, a library takes a
# third longer to compile and is no faster; nor is it with equations inside each of their callers, or the compiler searching all their
# branches for values that are at hand, which take another third. At clang's first level, which zig passes on only so, it takes two thirds
# of the time of the third and is no slower.
FLAGS = (
    *FAST_FLAGS,
    "-Xclang",
    "-O1",
    "-ffp-contract=fast",
    "-fno-unroll-loops",
    "-fno-slp-vectorize",
    "-DMODEL_CODE=static __attribute__((noinline, unused))",
    "-mllvm",
    "-memdep-block-number-limit=20",
)


def equations_text(model: Model) -> CText:
    """What the filter is compiled with of `model`."""
    return CText("model.h", model_header(model))


def build_filter(name: str, equations: CText) -> Path:
    """Compile the filter of the model called `name`; returns the library's path, raises BadInput when the compiler refuses."""
    made = (equations, CText("sincos_coefficients.h", sincos_header()))
    return build_shared("filter", (*made, *SOURCES, *HEADERS), flags=FLAGS, of=name)


def open_filter(path: Path, sizes: Mapping[str, int], axes: tuple[str, ...], stated_rad_s: float = 0.0) -> Filter:
    """Load a compiled filter whose model has `sizes["states"]` states and `sizes["outputs"]` outputs, of a plant as fast as stated."""
    declarations = "\n".join(line for line in DECLARATIONS.splitlines() if not line.startswith("#"))
    ffi, lib = load_shared(declarations, path)
    return Filter(sizes["states"], sizes["outputs"], axes, ffi, lib, stated_rad_s)
