"""Reference profiles: what a flight is asked to do."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Manoeuvre:
    """References of a plant's outputs, in their order, at evenly spaced times: t_s (n,), reference (n, outputs)."""

    t_s: Array
    reference: Array


@dataclass(frozen=True)
class Move:
    """From `at_s` on go to `angle_deg`: at once, or at `rate_deg_s` where that is above 0."""

    at_s: float
    angle_deg: float
    rate_deg_s: float = 0.0


# The manoeuvre of seed 000's Fig. 13 in spirit: elevation -30 .. 30 deg and back, azimuth 0/30/-30/60/0, never both in one second.
FLIGHT_S = 105.0
ELEVATION = (
    *(Move(at_s, angle) for at_s, angle in ((0, -30), (10, -20), (18, -10), (26, 0), (34, 10), (42, 20), (50, 30))),
    Move(64.0, -30.0, 10.0),
    Move(78.0, 0.0, 20.0),
    Move(95.0, -20.0),
)
AZIMUTH = (Move(0.0, 0.0), Move(14.0, 30.0), Move(30.0, -30.0), Move(57.0, 60.0), Move(86.0, 0.0))


def helicopter_flight(sample_period_s: float, start_deg: tuple[float, float]) -> Manoeuvre:
    """The project's flight of 105 s for a two-axis helicopter at rest at `start_deg` (elevation, azimuth)."""
    t_s = np.arange(round(FLIGHT_S / sample_period_s)) * sample_period_s
    moves = zip((ELEVATION, AZIMUTH), start_deg, strict=True)
    return Manoeuvre(t_s, np.column_stack([profile(t_s, one, start) for one, start in moves]))


def profile(t_s: Array, moves: Sequence[Move], start_deg: float) -> Array:
    """One reference [rad] over t_s (n,) that makes `moves` one after the other from `start_deg`."""
    angle_deg = np.full(len(t_s), start_deg)
    for move in moves:
        after = t_s >= move.at_s - 1e-9
        begin = angle_deg[after][0] if after.any() else start_deg
        distance = move.angle_deg - begin
        travelled = move.rate_deg_s * (t_s[after] - move.at_s) if move.rate_deg_s else np.full(after.sum(), np.inf)
        angle_deg[after] = begin + np.sign(distance) * np.minimum(abs(distance), travelled)
    return np.radians(angle_deg)
