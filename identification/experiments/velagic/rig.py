"""The rig of seed 001 in plain numbers: its equations as the paper writes them, psi from the vertical, voltages in machine units.

Nothing is shared with sim/: other variables, other integration. Experiments on simulated data are performed here.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.bind import BoundPlant

Array = NDArray[np.float64]
PERIOD_S = 0.01
SUBSTEPS = 2  # Runge-Kutta steps per sample
UPRIGHT = math.pi / 2  # psi of a level arm
State = tuple[float, ...]  # lag and speed of both motors as shares of those at 1 MU; psi, psi', phi, phi'
PSI, PHI = 4, 6


@dataclass(frozen=True, eq=False)
class VelagicRig:
    """A rig with the true parameters of `truth`; `azimuth_locked` is the screw that holds its horizontal axis."""

    truth: BoundPlant
    azimuth_locked: bool = False

    def rest(self) -> State:
        """Motors off, the arm on its lower stop, azimuth 0."""
        return (0.0, 0.0, 0.0, 0.0, UPRIGHT - self.truth.parameter("Psi_lim"), 0.0, 0.0, 0.0)

    def run(self, x: State, u_MU: ArrayLike) -> list[State]:
        """States at the n + 1 samples from x on, with voltages u_MU (n, 2) held for a sample each."""
        p = {name: entry.values[0] for name, entry in self.truth.plant.parameters.items()}
        if self.azimuth_locked:
            p["Ic_inv"] = 0.0  # a screw makes the azimuth's inertia infinite
        history = [x]
        for u_1, u_2 in np.asarray(u_MU, dtype=float).tolist():
            for _ in range(SUBSTEPS):
                x = _stopped(_step(p, x, u_1, u_2, PERIOD_S / SUBSTEPS), p)
            history.append(x)
        return history

    def angles_rad(self, history: list[State]) -> tuple[Array, Array]:
        """Elevation from the horizontal and azimuth, (n,) each, as the encoders show them."""
        sensors, states = self.truth.plant.sensors, np.array(history)
        found = ((states[:, PSI] - UPRIGHT, sensors["psi_rad"]), (states[:, PHI], sensors["phi_rad"]))
        psi, phi = (np.round(angle / step) * step for angle, step in found)
        return psi, phi

    def balance_MU(self, u_1: float) -> float:
        """The tail motor's voltage that holds the azimuth against the main motor's reaction, as one finds it by trial."""
        a_2, b_2, a_3, b_3 = (self.truth.parameter(name) for name in ("a_2", "b_2", "a_3", "b_3"))
        return (math.sqrt(b_2**2 + 4.0 * a_2 * (a_3 * u_1 + b_3) * u_1) - b_2) / (2.0 * a_2)


def _stopped(x: State, p: dict[str, float]) -> State:
    """The state with what is beyond a stop put onto it; a stop takes the speed."""
    *motors, psi, psi_dot, phi, phi_dot = x
    if abs(psi - UPRIGHT) >= p["Psi_lim"]:
        side = math.copysign(1.0, psi - UPRIGHT)
        psi, psi_dot = UPRIGHT + side * p["Psi_lim"], min(side * psi_dot, 0.0) * side
    if abs(phi) >= p["Phi_lim"]:
        side = math.copysign(1.0, phi)
        phi, phi_dot = side * p["Phi_lim"], min(side * phi_dot, 0.0) * side
    return (*motors, psi, psi_dot, phi, phi_dot)


def _rates(p: dict[str, float], x: State, u_1: float, u_2: float) -> State:
    """Eqs (3)-(7) without dry friction, which the identified set does not have."""
    lag_1, w_1, lag_2, w_2, psi, psi_dot, _, phi_dot = x
    tau_1 = p["a_1"] * w_1 * abs(w_1) + p["b_1"] * w_1
    tau_2 = p["a_2"] * w_2 * abs(w_2) + p["b_2"] * w_2
    tau_r = p["a_3"] * w_1 * abs(w_1) + p["b_3"] * w_1
    ml_kgm = p["tau_G"] / p["g"]
    centrifugal = 0.5 * ml_kgm * p["cf_length"] * phi_dot**2 * math.sin(2.0 * psi)
    gyroscopic = p["k_G"] * phi_dot * w_1 * math.cos(psi)
    elevation = tau_1 + centrifugal - p["B_psi"] * psi_dot - p["tau_G"] * math.sin(psi) + gyroscopic
    azimuth = (tau_2 - tau_r) * math.sin(psi) - p["B_phi"] * phi_dot
    return (
        (u_1 - lag_1) / p["T_1"],
        (lag_1 - w_1) / p["T_1"],
        (u_2 - lag_2) / p["T_2"],
        (lag_2 - w_2) / p["T_2"],
        psi_dot,
        p["I_inv"] * elevation,
        phi_dot,
        p["Ic_inv"] / math.sin(psi) * azimuth,
    )


def _step(p: dict[str, float], x: State, u_1: float, u_2: float, h: float) -> State:
    k1 = _rates(p, x, u_1, u_2)
    k2 = _rates(p, _moved(x, k1, h / 2.0), u_1, u_2)
    k3 = _rates(p, _moved(x, k2, h / 2.0), u_1, u_2)
    k4 = _rates(p, _moved(x, k3, h), u_1, u_2)
    return tuple(s + h / 6.0 * (a + 2.0 * b + 2.0 * c + d) for s, a, b, c, d in zip(x, k1, k2, k3, k4, strict=True))


def _moved(x: State, rates: State, h: float) -> State:
    return tuple(s + h * r for s, r in zip(x, rates, strict=True))
