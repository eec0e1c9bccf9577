"""How busy an input is: how far it travels and how often it turns round, whoever commands it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOVED_V = 1e-6  # one step of float32 at 10 V: a smaller change is rounding, and turns nothing round


@dataclass(frozen=True)
class Activity:
    """One input over a flight: the sum of |change| and the number of reversals, each per second of the flight.

    A reversal is a change against the last one, of MOVED_V at least each; samples at which the input holds its value are none,
    however many lie between.
    """

    travel_V_s: float
    reversals_1_s: float


def activity(t_s: Array, u_V: Array) -> Activity:
    """Of one input u_V (n,) in V as commanded at t_s (n,); a single sample has moved nothing."""
    duration_s = float(t_s[-1] - t_s[0])
    if duration_s == 0.0:
        return Activity(0.0, 0.0)
    changes = np.diff(u_V)
    turned = np.diff(np.sign(changes[np.abs(changes) > MOVED_V])) != 0.0
    return Activity(float(np.sum(np.abs(changes))) / duration_s, float(np.count_nonzero(turned)) / duration_s)
