"""Steady straight flight of the simulated helicopter: controls and attitude at a speed, altitude and rate of climb."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from identification.envelope.flights.conditions import Condition
from identification.envelope.truth.equations import Air, rates
from identification.envelope.truth.figures import Machine
from records.errors import BadInput

Array = NDArray[np.float64]
LEVEL_START = np.array([50.0, 50.0, 50.0, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0])


def air_of(machine: Machine, condition: Condition) -> Air:
    """Standard atmosphere at the altitude; the centre of gravity of the loading's second letter. Raises BadInput for a light one."""
    if condition.loading[0] != "H":
        raise BadInput(
            "loading", condition.name, condition.loading, "HA or HF", "the thesis, too, models heavy ones alone"
        )
    density = 1.225 * (1.0 - 2.25577e-5 * condition.altitude_m) ** 4.25588
    station_m = machine.station_aft_m if condition.loading[1] == "A" else machine.station_forward_m
    return Air(np.array([density]), np.array([station_m]))


def trim(machine: Machine, condition: Condition, climb_m_s: float) -> tuple[Array, Array]:
    """State (11,) and controls (4,) without sideslip and rotation, at rest but for the motion; raises BadInput where none is found.

    Unknown are the controls, phi, theta, the angle of attack, the disc's tilt and the induced velocity; the six accelerations and the
    rotor's three rates vanish, and the path climbs: u sin(theta) - w cos(phi) cos(theta) = climb.
    """
    air = air_of(machine, condition)
    still = np.zeros((3, 1))

    def excess(z: Array) -> Array:
        s, c = _unpacked(z, condition.speed_m_s)
        found = rates(machine, air, s, c, still)[:, 0]
        u, w, phi, theta = s[0, 0], s[2, 0], s[6, 0], s[7, 0]
        climb = u * np.sin(theta) - w * np.cos(phi) * np.cos(theta) - climb_m_s
        return np.concatenate([found[:6], found[8:], [climb]])

    found = root(excess, LEVEL_START, tol=1e-11)
    s, c = _unpacked(found.x, condition.speed_m_s)
    if np.abs(excess(found.x)).max() > 1e-6 or c.min() < 0.0 or c.max() > 100.0:
        got = f"controls {np.round(c[:, 0], 1).tolist()} %"
        raise BadInput("trim", f"{condition.name}, climb {climb_m_s:g} m/s", got, "a steady flight within the travel of the controls",
                       "fly slower or climb less")  # fmt: skip
    return s[:, 0], c[:, 0]


def _unpacked(z: Array, speed_m_s: float) -> tuple[Array, Array]:
    phi, theta, attack = z[4:7]
    body = [speed_m_s * np.cos(attack), 0.0, speed_m_s * np.sin(attack), 0.0, 0.0, 0.0, phi, theta]
    return np.array([*body, *z[7:]])[:, None], z[:4, None]
