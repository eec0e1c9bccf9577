"""The generated C as a careless build would run it: products and sums fused into one rounding."""

import platform
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from codegen.law import generate_law
from records.errors import BadInput
from records.table import ControllerTable
from toolchain.host import STRICT_FLOAT_FLAGS
from verification.host_law import HostLaw

Array = NDArray[np.float64]
HIDING = "    CHANGE_UNSEEN(product);\n"  # of the generated C, by which no compiler may fuse it: an older text had none


def fused_outputs(table: ControllerTable, inputs: NDArray[np.float32]) -> Array | None:
    """Outputs (n, loops) in V, from rest at the first row, of the law of `table` built with fused multiply-add.

    `inputs` (n, 2 loops) as the law takes them. None where this processor, or its compiler, has no such instruction.
    """
    if not _has_fused_multiply_add():
        return None
    try:
        law = careless_law(table)
    except BadInput:
        return None
    bits = np.ascontiguousarray(inputs[:, np.newaxis], dtype=np.float32).view(np.uint32)
    _, outputs = law.run(law.start(np.ascontiguousarray(bits[0, :, len(table.loops) :])), bits)
    return np.asarray(outputs[:, 0].view(np.float32), dtype=float)


def careless_law(table: ControllerTable) -> HostLaw:
    """The law of `table` without what keeps its products from being fused, built so that they are; raises BadInput where the compiler has
    no such instruction."""
    flags = [flag for flag in STRICT_FLOAT_FLAGS if "contract" not in flag]
    machine = ["-mfma"] if platform.machine() in ("x86_64", "AMD64") else []
    texts = {name: text.replace(HIDING, "") for name, text in generate_law(table).items()}
    return HostLaw(texts, flags=(*flags, "-ffp-contract=fast", *machine), loops=table.loops)


def _has_fused_multiply_add() -> bool:
    if platform.machine() not in ("x86_64", "AMD64"):
        return platform.machine() in ("aarch64", "arm64")
    try:
        return " fma " in Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return False
