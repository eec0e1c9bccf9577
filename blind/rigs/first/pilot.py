"""Gains of the benchmark's own controller: pole placement on this package's own linearisation, tabled over elevation."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import place_poles

from blind.rigs.first.simulation import FASTEST_RAD_S, PERIOD_S, PROGRAM
from blind.simulation.ce150 import Rig
from blind.simulation.native import opened
from blind.simulation.rest import rest, rotor_damping, rotor_thrust

Array = NDArray[np.float64]
TABLED_POINTS = 9
TABLED_RAD = 0.74
# rad/s, at bandwidth 1: integral, body twice, rotor.
POLES = (np.array([-1.6, -2.8, -3.6, -8.5]), np.array([-1.2, -2.2, -2.8, -6.0]))


def rotor_slope(rig: Rig, rotor: str, speed_rad_s: float) -> tuple[float, float]:
    """(d(P_b(w) w)/dw in 1/s, dF/dw in N s/rad) of a rotor ("M" or "T") at a speed."""
    w = abs(speed_rad_s)
    return float(rotor_damping(rig, rotor).deriv()(w)), float(rotor_thrust(rig, rotor).deriv()(w))


def make_pilot(rig: Rig, bandwidth: float) -> Any:
    """The C structure control_t for a rig, with all poles times `bandwidth`."""
    ffi, _ = opened(PROGRAM)
    grid = np.linspace(-TABLED_RAD, TABLED_RAD, TABLED_POINTS)
    pilot = ffi.new("control_t *", {"points": TABLED_POINTS, "from_rad": grid[0], "step_rad": grid[1] - grid[0]})
    pilot.track_rad_s, pilot.period_s = 32.0, PERIOD_S
    for index, psi in enumerate(grid):
        volts, speeds = rest(rig, psi, FASTEST_RAD_S)
        for axis in range(2):
            pilot.rest_V[axis][index], pilot.rest_rad_s[axis][index] = volts[axis], speeds[axis]
            for entry, gain in enumerate(_gains(rig, axis, psi, speeds[axis], bandwidth)):
                pilot.gain[axis][index][entry] = gain
    return pilot


def _gains(rig: Rig, axis: int, psi: float, speed: float, bandwidth: float) -> Array:
    """Gains on (integral of r - y, r - y, -y', rest speed - speed)."""
    rotor, body = ("M", "E") if axis == 0 else ("T", "A")
    lag, lift = rotor_slope(rig, rotor, speed)
    inertia = rig.value(f"J_{body}")
    stiffness = rig.value("tau_gE") * np.sin(psi) / inertia if axis == 0 else 0.0
    A = np.zeros((4, 4))
    A[0, 1] = -1.0
    A[1, 2] = 1.0
    A[2, 1:] = stiffness, -rig.value(f"b_v{body}") / inertia, rig.value(f"l_{rotor}") * lift / inertia
    A[3, 3] = -lag
    B = np.array([[0.0], [0.0], [0.0], [rig.value(f"K_{rotor}")]])
    K = place_poles(A, B, POLES[axis] * bandwidth).gain_matrix[0]
    return np.array([-K[0], K[1], K[2], K[3]])
