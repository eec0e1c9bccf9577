"""What a rig is asked for, and what a run is then flown with."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from blind.rigs.shaping import smoothed

Array = NDArray[np.float64]
Held = tuple[bool, bool]
DOUBLET_S = 0.08  # after which a push is followed by its opposite, on an axis that turns freely
WASHOUT_S = 2.0  # after which a command that an axis only integrates is taken back


@dataclass(frozen=True, eq=False)
class Orders:
    """What a run is flown with, see RealInputs; `start` (6,): angle, rate of both axes, speeds of both rotors or what else lags."""

    gain: Array
    rate_filter_s: float
    reference: Array
    base_V: Array
    start: Array


@dataclass(frozen=True, eq=False)
class Asked:
    """What somebody wants of a rig: wishes (n, 2) of size about 1 over times (n,) in s, the axes that are held."""

    wishes: Array
    t_s: Array
    locked: Held

    @property
    def period_s(self) -> float:
        """Of the rows."""
        return float(self.t_s[1] - self.t_s[0])

    def washed(self, i: int, time_s: float = WASHOUT_S) -> Array:
        """A wish that comes back to zero."""
        keep = np.exp(-self.period_s / time_s)
        return np.asarray(lfilter([1.0, -1.0], [1.0, -keep], self.wishes[:, i]))

    def doublets(self, i: int) -> Array:
        """A wish that comes back to zero twice, so that a push is soon followed by its opposite."""
        keep = np.exp(-self.period_s / DOUBLET_S)
        return np.asarray(lfilter([1.0, -1.0], [1.0, -keep], self.washed(i, DOUBLET_S)))

    def smooth(self, i: int, time_s: float) -> Array:
        """A wish behind two lags."""
        return smoothed(self.wishes[:, i], self.period_s, time_s)


def free(base_V: Array, start: Array) -> Orders:
    return Orders(np.zeros((2, 3)), 1.0, np.zeros_like(base_V), base_V, start)


def alone(values: Array) -> Array:
    """What a plant with one of it is given in the first of two columns."""
    return np.column_stack([values, np.zeros_like(values)])


def at_rest(angle: float, *lagging: float) -> Array:
    """The start (6,) of a plant with one axis."""
    start = np.zeros(6)
    start[0] = angle
    start[4 : 4 + len(lagging)] = lagging
    return start
