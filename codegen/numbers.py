"""Numbers in C text: the one place where a value becomes digits."""

import math

import numpy as np


def c_float32(value: float) -> str:
    """`value`, rounded to float32, as a C literal of 9 significant digits, which read back to the same bits.

    Eight digits are not enough: some float32 values would come back one ulp off. Raises ValueError for what is not finite.
    """
    if not math.isfinite(value):
        raise ValueError(f"no C literal for {value}")
    digits = f"{float(np.float32(value)):.9g}"
    return f"{digits}f" if any(mark in digits for mark in ".e") else f"{digits}.0f"


def float32_bits(value: float | np.float32) -> int:
    """The 32 bits of `value` rounded to float32, as an unsigned integer."""
    return int(np.float32(value).view(np.uint32))
