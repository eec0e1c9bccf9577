"""How far and how fast a loop's output is taken to go: of an angle what a shaft does, of anything else what its references' range says."""

import math
from typing import Protocol

from records.loops import Loop

# Rates that hold for the CE150 by a margin: full thrust from stop to stop without friction reaches 10.5 rad/s in elevation, full thrust
# and reaction torque against the damping 8.4 rad/s in azimuth.
FASTEST_RAD_S = 15.0
# A sampled loop needs so many periods for a rise that it is to follow; nothing that it controls crosses its range faster.
PERIODS_A_RISE = 20


class Ranged(Protocol):
    """What is asked of an axis."""

    @property
    def reference_min_rad(self) -> float:
        """Least reference."""

    @property
    def reference_max_rad(self) -> float:
        """Largest reference."""


def widest_reference(axis: Ranged) -> float:
    """The largest |reference|."""
    return max(abs(axis.reference_min_rad), abs(axis.reference_max_rad))


def room(loop: Loop, axis: Ranged) -> float:
    """How far beyond its references an output may be found: an angle a quarter turn, anything else as far as their range is wide."""
    return math.pi / 2.0 if loop.output_unit == "rad" else _width(axis)


def widest_error(loop: Loop, axis: Ranged) -> float:
    """No shaft turns further than once round against its reference, and nothing else further than its room is wide."""
    return 2.0 * math.pi if loop.output_unit == "rad" else 2.0 * (widest_reference(axis) + room(loop, axis))


def fastest(loop: Loop, axis: Ranged, sample_period_s: float) -> float:
    """How fast an output may move, a second."""
    return FASTEST_RAD_S if loop.output_unit == "rad" else _width(axis) / (PERIODS_A_RISE * sample_period_s)


def _width(axis: Ranged) -> float:
    return axis.reference_max_rad - axis.reference_min_rad
