"""The samples of a CE150 that a case's training runs went through."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Visited:
    """Angles in rad, rates in rad/s, rotor speeds in rad/s, commands in V, times in s: shape (n,) each.

    Times count from the first row, to which the logs give the time `start_s`. `tail_thrust`: rad/s -> N.
    """

    t_s: Array
    psi: Array
    psi_dot: Array
    phi: Array
    phi_dot: Array
    omega_M: Array
    omega_T: Array
    u_M: Array
    u_T: Array
    gravity_Nm: float
    tail_thrust: Callable[[Array], Array]
    start_s: float = 0.0

    def angle(self, axis: int) -> Array:
        """Angle of axis 0 (elevation) or 1 (azimuth), rad."""
        return (self.psi, self.phi)[axis]

    def rate(self, axis: int) -> Array:
        """Rate of an axis, rad/s."""
        return (self.psi_dot, self.phi_dot)[axis]

    def omega(self, rotor: int) -> Array:
        """Speed of rotor 0 (main) or 1 (tail), rad/s."""
        return (self.omega_M, self.omega_T)[rotor]

    def u(self, rotor: int) -> Array:
        """Command of a rotor, V."""
        return (self.u_M, self.u_T)[rotor]

    @property
    def load(self) -> Array:
        """What both drivers ask of their supply, as a share of 10 V."""
        return (np.abs(self.u_M) + np.abs(self.u_T)) / 10.0
