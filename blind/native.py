"""Arrays and settings on their way into compiled code."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind.effect import Settings

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
