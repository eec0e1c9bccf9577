"""Who flies the real rigs: commands of an open loop from a trim found by hand, or references with a PID and what it is given besides."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import lfilter

from blind.rigs.real.plants import RealPlant
from blind.rigs.shaping import smoothed
from blind.simulation.ce150 import Rig
from blind.simulation.rest import rest

Array = NDArray[np.float64]
Held = tuple[bool, bool]
CLOSED_SHARE = {"ce150": 0.6, "aeroshield": 0.3, "emps": 0.7, "quanser_aero": 0.5}  # of the logs
FASTEST_RAD_S = 1500.0
WASHOUT_S = 2.0  # after which a command that an axis only integrates is taken back
# Angle, integral and rate gains in V/rad, V/(rad s), V s/rad.
CE150_GAINS = np.array([[3.8, 2.3, 2.0], [3.0, 0.8, 1.5]])
AEROSHIELD_GAINS = np.array([2.5, 8.0, 0.25])
AERO_GAINS = np.array([[20.0, 6.0, 15.0], [15.0, 3.0, 14.0]])


@dataclass(frozen=True, eq=False)
class Orders:
    """What a run is flown with, see RealInputs; `start` (6,): angle, rate of both axes, speeds of both rotors."""

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

    def washed(self, i: int) -> Array:
        """A wish that comes back to zero."""
        keep = np.exp(-self.period_s / WASHOUT_S)
        return np.asarray(lfilter([1.0, -1.0], [1.0, -keep], self.wishes[:, i]))

    def smooth(self, i: int, time_s: float) -> Array:
        """A wish behind two lags."""
        return smoothed(self.wishes[:, i], self.period_s, time_s)


def opened(
    plant: RealPlant, nominal: Rig, true: Rig, wishes: Array, locked: Held, t_s: Array, rng: Generator
) -> Orders:
    """Commands made beforehand, about a trim that the operator found on the rig itself."""
    return OPEN[plant.name](true, Asked(wishes, t_s, locked), rng)


def closed(
    plant: RealPlant, nominal: Rig, true: Rig, wishes: Array, locked: Held, t_s: Array, rng: Generator
) -> Orders:
    """References, and a controller that knows the rig as it is stated."""
    return CLOSED[plant.name](nominal, Asked(wishes, t_s, locked), rng)


def _free(base_V: Array, start: Array) -> Orders:
    return Orders(np.zeros((2, 3)), 1.0, np.zeros_like(base_V), base_V, start)


def _ce150_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """Below level the arm's weight brings it back; the azimuth only comes to rest."""
    psi = float(rng.uniform(-0.5, -0.15))
    phi = float(rng.uniform(-0.5, 0.5))
    trim_V, speeds = rest(rig, psi, FASTEST_RAD_S)
    size_V = (float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.8, 2.0)))
    base_V = trim_V + np.column_stack([size_V[0] * asked.wishes[:, 0], size_V[1] * asked.washed(1)])
    if asked.locked[0]:
        base_V[:, 0] = trim_V[0] + 4.0 * size_V[0] * asked.wishes[:, 0]
    return _free(np.ascontiguousarray(base_V), np.array([psi, 0.0, phi, 0.0, *speeds]))


def _ce150_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """A PID for each axis; what the rig needs at rest is fed forward from a table."""
    times_s, middle = rng.uniform(0.15, 0.4, 2), rng.uniform(-0.15, 0.1)
    reference = np.column_stack([middle + 0.4 * asked.smooth(0, times_s[0]), 1.1 * asked.smooth(1, times_s[1])])
    for i in range(2):
        if asked.locked[i]:
            reference[:, i] = reference[0, i]
    grid = np.linspace(-0.7, 0.7, 15)
    table = np.array([rest(rig, float(psi), FASTEST_RAD_S)[0] for psi in grid])
    base_V = np.column_stack([np.interp(reference[:, 0], grid, table[:, i]) for i in range(2)])
    if rng.random() < 0.4:
        base_V += np.array([0.3, 0.8]) * np.clip(
            lfilter([1.0], [1.0, -0.8], rng.standard_normal(base_V.shape), axis=0), -3.0, 3.0
        )
    b = rng.uniform(0.8, 1.1, (2, 1))
    gain = CE150_GAINS * np.hstack([b**2, b**3, b])
    speeds = rest(rig, float(reference[0, 0]), FASTEST_RAD_S)[1]
    start = np.array([reference[0, 0], 0.0, reference[0, 1], 0.0, *speeds])
    return Orders(gain, float(rng.uniform(0.02, 0.05)), reference, np.ascontiguousarray(base_V), start)


def _sine_of_rest(rig: Rig, u_V: Array | float) -> Array:
    """sin(angle) at which an AeroShield rests."""
    return np.asarray(rig.value("K") * u_V / (rig.value("m") * rig.value("g")))


def _aeroshield_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """About a third of what lifts the arm level."""
    level_V = rig.value("m") * rig.value("g") / rig.value("K")
    middle, size = level_V * rng.uniform(0.3, 0.45), level_V * rng.uniform(0.15, 0.3)
    u = np.clip(middle + size * asked.wishes[:, 0], 0.0, rig.value("u_max"))
    angle = float(np.arcsin(np.clip(_sine_of_rest(rig, u[0]), 0.0, 0.95)))
    return _free(np.column_stack([u, np.zeros_like(u)]), np.array([angle, 0.0, 0.0, 0.0, 0.0, 0.0]))


def _aeroshield_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    angle = rng.uniform(0.35, 0.5) + 0.3 * asked.smooth(0, float(rng.uniform(0.05, 0.2)))
    level_V = rig.value("m") * rig.value("g") / rig.value("K")
    base = level_V * np.sin(angle)
    nothing = np.zeros_like(angle)
    gain = np.array([AEROSHIELD_GAINS * rng.uniform(0.6, 1.2, 3), np.zeros(3)])
    start = np.array([angle[0], 0.0, 0.0, 0.0, 0.0, 0.0])
    return Orders(gain, 0.03, np.column_stack([angle, nothing]), np.column_stack([base, nothing]), start)


def _emps_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    u = rng.uniform(1.0, 2.5) * asked.washed(0)
    return _free(np.column_stack([u, np.zeros_like(u)]), np.zeros(6))


def _emps_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """A PD of a bandwidth that its rows allow."""
    q = 0.1 * asked.smooth(0, float(rng.uniform(0.15, 0.35)))
    bandwidth = min(30.0, 0.2 / asked.period_s) * rng.uniform(0.6, 1.0)
    stiff = rig.value("M") * bandwidth**2 / rig.value("gtau")
    gain = np.array([[stiff, 0.0, 1.6 * stiff / bandwidth], [0.0, 0.0, 0.0]])
    nothing = np.zeros_like(q)
    reference = np.column_stack([q, nothing])
    return Orders(
        gain, 2.0 * asked.period_s, reference, np.zeros_like(reference), np.array([q[0], 0.0, 0.0, 0.0, 0.0, 0.0])
    )


def _aero_trim(rig: Rig, pitch: Array) -> tuple[Array, float]:
    """(main voltage that holds a pitch, tail voltage in one of it that leaves the yaw alone)."""
    tail = float(np.sqrt(rig.value("Kmp") / rig.value("Ktp")))
    lift = rig.value("dt") * rig.value("K_omega") ** 2 * (rig.value("Kmt") + rig.value("Ktt") * tail**2)
    weight = rig.value("dx") * rig.value("g") * rig.value("me")
    return np.asarray(np.sqrt(weight * np.sin(np.maximum(pitch, 0.02)) / lift)), tail


def _aero_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """The tail follows the main rotor so that the yaw stands, and what is asked of it comes besides."""
    pitch = float(rng.uniform(0.25, 0.4))
    trim_V, tail = _aero_trim(rig, np.array([pitch]))
    main = trim_V[0] + rng.uniform(0.5, 1.5) * asked.wishes[:, 0]
    base_V = np.column_stack([main, tail * main + rng.uniform(1.5, 3.5) * asked.washed(1)])
    return _free(base_V, np.array([pitch, 0.0, float(rng.uniform(-0.5, 0.5)), 0.0, 0.0, 0.0]))


def _aero_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    times_s = rng.uniform(0.7, 1.4, 2)  # both rotors push one way only, and not far
    reference = np.column_stack(
        [rng.uniform(0.3, 0.4) + 0.15 * asked.smooth(0, times_s[0]), 0.6 * asked.smooth(1, times_s[1])]
    )
    for i in range(2):
        if asked.locked[i]:
            reference[:, i] = reference[0, i]
    main, tail = _aero_trim(rig, reference[:, 0])
    start = np.array([reference[0, 0], 0.0, reference[0, 1], 0.0, 0.0, 0.0])
    base_V = np.column_stack([main, tail * main])
    return Orders(AERO_GAINS * rng.uniform(0.7, 1.2, (2, 3)), 0.05, reference, base_V, start)


Operator = Callable[[Rig, Asked, Generator], Orders]
OPEN: Mapping[str, Operator] = {
    "ce150": _ce150_open,
    "aeroshield": _aeroshield_open,
    "emps": _emps_open,
    "quanser_aero": _aero_open,
}
CLOSED: Mapping[str, Operator] = {
    "ce150": _ce150_closed,
    "aeroshield": _aeroshield_closed,
    "emps": _emps_closed,
    "quanser_aero": _aero_closed,
}
