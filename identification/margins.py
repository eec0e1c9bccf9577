"""How close an estimated signal comes to the measured one: the FAA's tolerance margins, correlation and Theil's fit (seed 003, 1.6).

Every function takes `measured` first and `estimated` second, of equal shape (samples,), in one unit; a sample that is NaN in
either is left out. Nothing here knows a plant: a caller brings the margin of its own signal, or one of `MARGINS`.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FOOT_m = 0.3048
REQUIRED_s = 3.0  # an estimated signal has to stay within its margin for so long

ATTITUDE_MARGIN_rad = math.radians(1.5)
RATE_MARGIN_rad_s = math.radians(3.0)

_LEVEL = {
    "u_m_s": 5.0 * FOOT_m,
    "v_m_s": 4.0 * FOOT_m,
    "w_m_s": 3.0 * FOOT_m,
    "p_rad_s": RATE_MARGIN_rad_s,
    "q_rad_s": RATE_MARGIN_rad_s,
    "r_rad_s": RATE_MARGIN_rad_s,
    "phi_rad": ATTITUDE_MARGIN_rad,
    "theta_rad": ATTITUDE_MARGIN_rad,
    "A_x_m_s2": 3.0 * FOOT_m,
    "A_y_m_s2": 3.0 * FOOT_m,
    "A_z_m_s2": 3.0 * FOOT_m,
}
_ASCENDING = _LEVEL | {"w_m_s": 1.66 * FOOT_m, "theta_rad": math.radians(3.0)}

# Table 1.1: largest difference between estimate and measurement, by mission and signal (body axes, z down).
MARGINS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {"level": _LEVEL, "descending": _LEVEL, "autorotation": _LEVEL, "ascending": _ASCENDING}
)


def share_outside(measured: Array, estimated: Array, margin: float) -> float:
    """Share of the samples at which |estimated - measured| exceeds `margin` (0 to 1); NaN where no sample is left."""
    error = _error(measured, estimated)
    return float(np.mean(error > margin)) if error.size else math.nan


def held_s(measured: Array, estimated: Array, margin: float, sample_period_s: float) -> float:
    """How long [s] the estimate stays within `margin` from the first sample on, until its first exit or the record's end."""
    out = np.flatnonzero(np.abs(estimated - measured) > margin)
    return sample_period_s * float(out[0] if out.size else len(measured))


def rms_error(measured: Array, estimated: Array) -> float:
    """Root mean square of estimated - measured; NaN where no sample is left."""
    y, found = _both(measured, estimated)
    return _rms(found - y) if y.size else math.nan


def correlation(measured: Array, estimated: Array) -> float:
    """Correlation coefficient (1.2), -1 to 1: the trend alone; NaN where either signal does not vary."""
    y, found = _both(measured, estimated)
    if y.size < 2 or np.ptp(y) == 0.0 or np.ptp(found) == 0.0:
        return math.nan
    return float(np.corrcoef(y, found)[0, 1])


def theil(measured: Array, estimated: Array) -> float:
    """Theil's inequality coefficient U = rms(estimated - measured) / (rms(estimated) + rms(measured)), (1.4): 0 to 1, 0 is perfect.

    A common offset of both signals makes U small: take deviations from trim. 0.25 to 0.3 counts as good agreement
    (Jategaonkar 2006). NaN where no sample is left, 0 where both signals are zero throughout.
    """
    y, found = _both(measured, estimated)
    if y.size == 0:
        return math.nan
    size = _rms(y) + _rms(found)
    return _rms(found - y) / size if size > 0.0 else 0.0


def fit_percent(measured: Array, estimated: Array) -> float:
    """FIT = 100 (1 - U), (1.3): 100 is perfect."""
    return 100.0 * (1.0 - theil(measured, estimated))


def _rms(signal: Array) -> float:
    return float(np.sqrt(np.mean(signal**2)))


def _both(measured: Array, estimated: Array) -> tuple[Array, Array]:
    kept = np.isfinite(measured) & np.isfinite(estimated)
    return measured[kept], estimated[kept]


def _error(measured: Array, estimated: Array) -> Array:
    y, found = _both(measured, estimated)
    return np.abs(found - y)
