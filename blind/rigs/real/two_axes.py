"""Who flies the plants with two axes: a PID for each, or commands about a trim."""

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter

from blind.rigs.real.orders import Array, Asked, Orders, free
from blind.simulation.ce150 import Rig
from blind.simulation.rest import rest

FASTEST_RAD_S = 1500.0  # rotor speeds at rest are looked for up to here
# Angle, integral and rate gains in V/rad, V/(rad s), V s/rad.
CE150_GAINS = np.array([[3.8, 2.3, 2.0], [3.0, 0.8, 1.5]])
AERO_GAINS = np.array([[20.0, 6.0, 15.0], [15.0, 3.0, 14.0]])


def ce150_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """Below level the arm's weight brings it back; the azimuth only comes to rest."""
    psi = float(rng.uniform(-0.5, -0.15))
    phi = float(rng.uniform(-0.5, 0.5))
    trim_V, speeds = rest(rig, psi, FASTEST_RAD_S)
    size_V = (float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.8, 2.0)))
    base_V = trim_V + np.column_stack([size_V[0] * asked.wishes[:, 0], size_V[1] * asked.washed(1)])
    if asked.locked[0]:
        base_V[:, 0] = trim_V[0] + 4.0 * size_V[0] * asked.wishes[:, 0]
    return free(np.ascontiguousarray(base_V), np.array([psi, 0.0, phi, 0.0, *speeds]))


def ce150_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
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


def _aero_trim(rig: Rig, pitch: Array) -> tuple[Array, float]:
    """(main voltage that holds a pitch, tail voltage in one of it that leaves the yaw alone)."""
    tail = float(np.sqrt(rig.value("Kmp") / rig.value("Ktp")))
    lift = rig.value("dt") * rig.value("K_omega") ** 2 * (rig.value("Kmt") + rig.value("Ktt") * tail**2)
    weight = rig.value("dx") * rig.value("g") * rig.value("me")
    return np.asarray(np.sqrt(weight * np.sin(np.maximum(pitch, 0.02)) / lift)), tail


def aero_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """The tail follows the main rotor so that the yaw stands, and what is asked of it comes besides."""
    pitch = float(rng.uniform(0.25, 0.4))
    trim_V, tail = _aero_trim(rig, np.array([pitch]))
    main = trim_V[0] + rng.uniform(0.5, 1.5) * asked.wishes[:, 0]
    base_V = np.column_stack([main, tail * main + rng.uniform(1.5, 3.5) * asked.washed(1)])
    return free(base_V, np.array([pitch, 0.0, float(rng.uniform(-0.5, 0.5)), 0.0, 0.0, 0.0]))


def aero_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
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
