"""Gains of the benchmark's own controller: pole placement on this package's own linearisation, tabled over elevation."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.signal import place_poles

from blind.rigs.first.truth import library
from blind.simulation.ce150 import Rig

Array = NDArray[np.float64]
POINTS = 9
RANGE_RAD = 0.74
# rad/s, at bandwidth 1: integral, body twice, rotor.
POLES = (np.array([-1.6, -2.8, -3.6, -8.5]), np.array([-1.2, -2.2, -2.8, -6.0]))


def rotor_slope(rig: Rig, rotor: str, speed: float) -> tuple[float, float]:
    """(d(P_b(w) w)/dw, dF/dw) of a rotor ("M" or "T") at a speed."""
    w = abs(speed)
    damping = np.polynomial.Polynomial([0.0, *rig.values[f"p_b{rotor}"]])
    thrust = np.polynomial.Polynomial(rig.values[f"p_F{rotor}"])
    return float(damping.deriv()(w)), float(thrust.deriv()(w))


def rest(rig: Rig, psi_rad: float) -> tuple[Array, Array]:
    """(voltages, rotor speeds) that hold the rig still at an elevation."""
    lift = rig.value("tau_gE") * np.cos(psi_rad) / rig.value("l_M")
    main = _speed_for(rig, "M", lift)
    tail = _speed_for(rig, "T", rig.value("K_A") * main / rig.value("l_T"))
    speeds = np.array([main, tail])
    return np.array([_voltage_for(rig, rotor, speed) for rotor, speed in zip("MT", speeds, strict=True)]), speeds


def start_state(rig: Rig, psi_rad: float, phi_rad: float) -> Array:
    """The state (6,) at rest: psi psi' phi phi' omega_M omega_T."""
    _, speeds = rest(rig, psi_rad)
    return np.array([psi_rad, 0.0, phi_rad, 0.0, *speeds])


def make_pilot(rig: Rig, bandwidth: float) -> Any:
    """The C structure pilot_t for a rig, with all poles times `bandwidth`."""
    ffi, _ = library()
    grid = np.linspace(-RANGE_RAD, RANGE_RAD, POINTS)
    pilot = ffi.new("pilot_t *", {"points": POINTS, "from_rad": grid[0], "step_rad": grid[1] - grid[0]})
    pilot.track_rad_s = 32.0
    for index, psi in enumerate(grid):
        volts, speeds = rest(rig, psi)
        for axis in range(2):
            pilot.rest_V[axis][index], pilot.rest_rad_s[axis][index] = volts[axis], speeds[axis]
            for entry, gain in enumerate(_gains(rig, axis, psi, speeds[axis], bandwidth)):
                pilot.gain[axis][index][entry] = gain
    return pilot


def _speed_for(rig: Rig, rotor: str, force_N: float) -> float:
    thrust = np.polynomial.Polynomial(rig.values[f"p_F{rotor}"])
    return float(brentq(lambda w: thrust(w) - force_N, 0.0, 1000.0))


def _voltage_for(rig: Rig, rotor: str, speed: float) -> float:
    braking = np.polynomial.Polynomial([0.0, *rig.values[f"p_b{rotor}"]])
    return float(braking(speed)) / rig.value(f"K_{rotor}")


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
