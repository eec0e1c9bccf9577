"""Accelerations carried from where they are measured to the centre of gravity, eq (4) of seed 002.

    a_cg = a_meas - omega' x r_s - omega x (omega x r_s)

with r_s from the centre of gravity to the sensor. The paper prints plus signs, which hold for r_s counted from the sensor to the centre
of gravity; its text calls r_s the offset of the package relative to the centre of gravity, and for that the signs are minus.

omega' comes of noisy readings, so they are smoothed first, by a Butterworth filter of second order that runs forth and back (no phase) and
passes 1 / (1 + (omega / BANDWIDTH_rad_s)^4). Of white noise of standard deviation sd the slope keeps

    (1)  sd sqrt(2^0.5 / 16 BANDWIDTH_rad_s^3 T_s),

which is the integral of omega^2 / (1 + (omega / BANDWIDTH_rad_s)^4)^2 over all frequencies. Beyond its ends the signal goes on as the
parabola through its last readings, over two periods W = 4 pi / BANDWIDTH_rad_s of it, whose slope there is as noisy as (1). Of a motion
at omega that slope is off by at most

    (2)  (omega W)^2 / 10,

the parabola that is nearest to a cubic; a shorter one is nearer and noisier, as W^-1.5.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import butter, filtfilt, savgol_filter

from identification import thresholds

Array = NDArray[np.float64]
MOST_BAND = 0.8  # of half the sampling rate: a slower log is not smoothed below that
PARABOLA_PERIODS = 2.0
RINGING = 20.0  # time constants of the filter after which its memory is none


@dataclass(frozen=True, eq=False)
class Transferred:
    """Accelerations (n, 3) in m/s^2 at the centre of gravity, and what was taken off for the sensor's place: omega' x r_s (`turning`)
    and omega x (omega x r_s) (`centripetal`)."""

    a_cg_m_s2: Array
    turning_m_s2: Array
    centripetal_m_s2: Array


def to_centre_of_gravity(
    a_meas_m_s2: Array, omega_rad_s: Array, r_s_m: ArrayLike, sample_period_s: float
) -> Transferred:
    """Accelerations of the centre of gravity from those of the sensor and the body's rates p, q, r, all (n, 3)."""
    r = np.asarray(r_s_m, dtype=float)
    omega = smoothed(omega_rad_s, sample_period_s)
    turning, centripetal = lever_terms(omega, slopes_of(omega, sample_period_s), r)
    return Transferred(np.asarray(a_meas_m_s2 - turning - centripetal), turning, centripetal)


def lever_terms(omega_rad_s: Array, omega_dot_rad_s2: Array, r_s_m: Array) -> tuple[Array, Array]:
    """omega' x r_s and omega x (omega x r_s), (n, 3) in m/s^2: what the sensor reads beyond the centre of gravity."""
    return np.cross(omega_dot_rad_s2, r_s_m), np.cross(omega_rad_s, np.cross(omega_rad_s, r_s_m))


def smoothed(signal: Array, sample_period_s: float) -> Array:
    """Readings (n, channels) without what is faster than BANDWIDTH_rad_s."""
    share = min(thresholds.BANDWIDTH_rad_s * sample_period_s / math.pi, MOST_BAND)
    memory = math.ceil(RINGING / (share * math.pi))
    ends = min(max(math.ceil(PARABOLA_PERIODS * 2.0 / share), 3), signal.shape[0])
    before = _continued(signal[:ends][::-1], memory)[::-1]
    whole = np.concatenate([before, signal, _continued(signal[-ends:], memory)])
    return np.asarray(filtfilt(*butter(2, share), whole, axis=0, padlen=0)[memory:-memory])


def _continued(readings: Array, rows: int) -> Array:
    """The next rows (rows, channels) of the parabola through some readings."""
    at = np.arange(len(readings) + rows) / len(readings)
    degree = min(2, len(readings) - 1)
    powers = np.vander(at, degree + 1)
    return np.asarray(powers[len(readings) :] @ np.linalg.lstsq(powers[: len(readings)], readings, rcond=None)[0])


def slopes_of(signal: Array, sample_period_s: float) -> Array:
    """Time derivative of smoothed readings (n, channels): of a parabola of fourth degree through five of them."""
    return np.asarray(savgol_filter(signal, 5, 4, deriv=1, delta=sample_period_s, axis=0))


def off_at_the_ends(omega_rad_s: float) -> float:
    """(2): the share by which the first and the last slope of a motion at that frequency may be off."""
    length_s = PARABOLA_PERIODS * 2.0 * math.pi / thresholds.BANDWIDTH_rad_s
    return (omega_rad_s * length_s) ** 2 / 10.0


def lever_noise_m_s2(omega_sd_rad_s: ArrayLike, r_s_m: ArrayLike, sample_period_s: float) -> Array:
    """(1) carried to the centre of gravity: the standard deviation (3,) that noise of the rates (3,) leaves in each acceleration."""
    gain = math.sqrt(math.sqrt(2.0) / 16.0 * thresholds.BANDWIDTH_rad_s**3 * sample_period_s)
    sd, r = (np.asarray(value, dtype=float) for value in (omega_sd_rad_s, r_s_m))
    by_axis = np.cross(np.diag(gain * sd), r)
    return np.asarray(np.linalg.norm(by_axis, axis=0))
