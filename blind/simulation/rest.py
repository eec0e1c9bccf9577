"""The plant's equations at rest: what holds the rig still."""

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.optimize import brentq

from blind.simulation.ce150 import Rig

Array = NDArray[np.float64]


def rest(rig: Rig, psi_rad: float, fastest_rad_s: float) -> tuple[Array, Array]:
    """(voltages (2,) V, rotor speeds (2,) rad/s) that hold the rig still at an elevation; speeds are looked for up to `fastest_rad_s`.

    l_M F_M(omega_M) = tau_g cos(psi), l_T F_T(omega_T) = K_A omega_M, K u = P_b(omega) omega.
    """
    main = _speed(rig, "M", rig.value("tau_gE") * np.cos(psi_rad) / rig.value("l_M"), fastest_rad_s)
    tail = _speed(rig, "T", rig.value("K_A") * main / rig.value("l_T"), fastest_rad_s)
    speeds = np.array([main, tail])
    return np.array([_voltage(rig, rotor, speed) for rotor, speed in zip("MT", speeds, strict=True)]), speeds


def start_state(rig: Rig, psi_rad: float, phi_rad: float, fastest_rad_s: float) -> Array:
    """The state (6,) at rest: psi psi' phi phi' omega_M omega_T."""
    _, speeds = rest(rig, psi_rad, fastest_rad_s)
    return np.array([psi_rad, 0.0, phi_rad, 0.0, *speeds])


def rotor_damping(rig: Rig, rotor: str) -> Polynomial:
    """P_b(omega) omega of a rotor ("M" or "T") that turns forward, rad/s^2."""
    return Polynomial([0.0, *rig.values[f"p_b{rotor}"]])


def rotor_thrust(rig: Rig, rotor: str) -> Polynomial:
    """F(omega) of a rotor that turns forward, N."""
    return Polynomial(rig.values[f"p_F{rotor}"])


def _speed(rig: Rig, rotor: str, force_N: float, fastest_rad_s: float) -> float:
    force = rotor_thrust(rig, rotor)
    return float(brentq(lambda w: force(w) - force_N, 0.0, fastest_rad_s))


def _voltage(rig: Rig, rotor: str, speed_rad_s: float) -> float:
    return float(rotor_damping(rig, rotor)(speed_rad_s)) / rig.value(f"K_{rotor}")
