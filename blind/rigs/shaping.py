"""What a reference goes through before a rig is asked for it."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]


def smoothed(raw: Array, step_s: float, time_s: float) -> Array:
    """`raw` (n,) behind two lags of `time_s` in a row, at rest at the first value."""
    keep = np.exp(-step_s / time_s)
    b, a = [1.0 - keep], [1.0, -keep]
    return np.ascontiguousarray(lfilter(b, a, lfilter(b, a, raw - raw[0])) + raw[0])
