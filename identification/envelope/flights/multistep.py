"""Multistep pilot inputs (seed 003, 1.2.1): steps of alternating sign whose lengths are whole numbers of a unit time, and their spectra."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEPS_2311 = (2, 3, 1, 1)  # keeps the machine near trim before the longest step
STEPS_3211 = (3, 2, 1, 1)  # the classical one, wide in spectrum
DOUBLET = (1, 1)
PULSE = (1,)


def multistep(t_s: Array, steps: Sequence[int], unit_s: float, start_s: float = 0.0, ramp_s: float = 0.0) -> Array:
    """The input of height 1 at the times `t_s` (n,): +1 for steps[0] units, -1 for steps[1], and so on, 0 elsewhere.

    A pilot's hand needs `ramp_s` for each change, which is straight and centred on the edge.
    """
    edges_s = start_s + unit_s * np.concatenate([[0.0], np.cumsum(steps)])
    levels = np.concatenate([[0.0], [(-1.0) ** i for i in range(len(steps))], [0.0]])
    if ramp_s <= 0.0:
        return np.asarray(levels[np.searchsorted(edges_s, t_s, side="right")])
    corners_s = np.ravel(np.column_stack([edges_s - ramp_s / 2, edges_s + ramp_s / 2]))
    heights = np.ravel(np.column_stack([levels[:-1], levels[1:]]))
    return np.asarray(np.interp(t_s, corners_s, heights))


def spectrum(frequency_Hz: Array, steps: Sequence[int], unit_s: float) -> Array:
    """Energy spectral density |U(f)|^2 [s^2] of the input of height 1, exact.

    U(f) = sum_i s_i (exp(-j w t_i) - exp(-j w t_(i+1))) / (j w) with w = 2 pi f; U(0) = sum_i s_i (t_(i+1) - t_i).
    """
    edges_s = unit_s * np.concatenate([[0.0], np.cumsum(steps)])
    signs = (-1.0) ** np.arange(len(steps))
    length_s, middle_s = np.diff(edges_s), (edges_s[:-1] + edges_s[1:]) / 2
    turn = np.outer(frequency_Hz, middle_s)
    # Each step is its length times a sinc (numpy's, of pi f T) turned by its middle, which is also right at f = 0.
    U = (signs * length_s * np.sinc(np.outer(frequency_Hz, length_s)) * np.exp(-2j * np.pi * turn)).sum(axis=1)
    return np.asarray(np.abs(U) ** 2)


def band_Hz(steps: Sequence[int], unit_s: float, share: float = 0.5) -> tuple[float, float]:
    """The band around the spectrum's peak in which the density is above `share` of it; its relative width tells how broad the input is."""
    f = np.linspace(0.0, 1.0 / unit_s, 4001)
    density = spectrum(f, steps, unit_s)
    peak = int(np.argmax(density))
    low = density >= share * density[peak]
    below = np.flatnonzero(~low[:peak])
    above = np.flatnonzero(~low[peak:])
    first = f[below[-1] + 1] if below.size else 0.0
    last = f[peak + above[0] - 1] if above.size else f[-1]
    return float(first), float(last)
