"""The frequency sweep: which band it covers, how long it must last, and its input over time.

Rules of ref [5] of seed 002, for a band from low to high: one period of the lowest frequency lasts T_max = 2 pi / low; a record holds
at least four of these, a window at least two, and there are at least five readings in the shortest period. With C1 = 4 and C2 = 0.0187,

    (1)  omega(t) = low + C2 (exp(C1 t / T) - 1) (high - low),    delta(t) = amplitude sin(integral of omega)

which dwells on low frequencies and reaches `high` at the end (C2 (exp(C1) - 1) = 1.002). One period of the lowest frequency comes
first, so that it is excited as long as the rules ask for.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput

Array = NDArray[np.float64]
C1, C2 = 4.0, 0.0187
RECORD_PERIODS, WINDOW_PERIODS = 4.0, 2.0
READINGS_PER_PERIOD = 5.0
FADE_S = 2.0


@dataclass(frozen=True)
class Sweep:
    """A sweep from `low_rad_s` to `high_rad_s` that lasts `sweep_s`, between `rest_s` of trim on either side."""

    low_rad_s: float
    high_rad_s: float
    sweep_s: float
    rest_s: float = 3.0

    @property
    def duration_s(self) -> float:
        """With the rests."""
        return self.sweep_s + 2.0 * self.rest_s


def design_sweep(low_rad_s: float, high_rad_s: float, sample_period_s: float, sweep_s: float | None = None) -> Sweep:
    """A sweep over the band, by default 5.5 periods of its lowest frequency long.

    Raises BadInput for a band that is none, one that the sampling cannot carry, or a duration too short for the lowest frequency.
    """
    band = f"{low_rad_s:g} to {high_rad_s:g} rad/s"
    if not 0.0 < low_rad_s < high_rad_s < math.inf:
        raise BadInput("band", "frequency sweep", band, "0 < lowest < highest", "give two frequencies")
    most = highest_rad_s(sample_period_s)
    if high_rad_s > most:
        raise BadInput(
            "highest frequency", "frequency sweep", f"{high_rad_s:g} rad/s",
            f"at most {most:.4g} rad/s, five readings a period at {sample_period_s:g} s", "sample faster, or sweep lower",
        )  # fmt: skip
    least_s = record_s(low_rad_s)
    length_s = 1.375 * least_s if sweep_s is None else sweep_s
    if not least_s <= length_s < math.inf:
        raise BadInput(
            "duration", "frequency sweep", f"{length_s:g} s",
            f"at least {least_s:.4g} s, {RECORD_PERIODS:g} periods of {low_rad_s:g} rad/s",
            f"sweep longer, or begin at {2.0 * math.pi * RECORD_PERIODS / max(length_s, 1e-9):.3g} rad/s",
        )  # fmt: skip
    return Sweep(low_rad_s, high_rad_s, length_s)


def record_s(low_rad_s: float) -> float:
    """The least length of a record that tells of `low_rad_s`."""
    return RECORD_PERIODS * 2.0 * math.pi / low_rad_s


def highest_rad_s(sample_period_s: float) -> float:
    """The highest frequency that readings every `sample_period_s` carry."""
    return 2.0 * math.pi / (READINGS_PER_PERIOD * sample_period_s)


def phase_rad(sweep: Sweep, t_s: Array) -> Array:
    """The integral of omega in (1), from the sweep's own beginning."""
    hold_s = 2.0 * math.pi / sweep.low_rad_s
    rising_s = sweep.sweep_s - hold_s
    late_s = np.clip(t_s - hold_s, 0.0, rising_s)
    growth = rising_s / C1 * np.expm1(C1 * late_s / rising_s) - late_s
    return np.asarray(sweep.low_rad_s * t_s + C2 * (sweep.high_rad_s - sweep.low_rad_s) * growth)


def sweep_input(sweep: Sweep, t_s: Array, amplitude: float) -> Array:
    """(1) at t_s (n,), in the unit of `amplitude`: 0 outside the sweep, faded in and out within two seconds."""
    own_s = np.clip(t_s - sweep.rest_s, 0.0, sweep.sweep_s)
    ends = np.minimum(own_s, sweep.sweep_s - own_s) / FADE_S
    return np.asarray(amplitude * np.clip(ends, 0.0, 1.0) * np.sin(phase_rad(sweep, own_s)))
