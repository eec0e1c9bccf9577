"""The closed loop: a controller, whatever it is made of, flies the compiled plant."""

from typing import Protocol


class Controller(Protocol):
    """What can fly the two-axis helicopter: a float law, its twin, compiled C, an emulated or a real board.

    `step` is called once per sample, in order; all angles in rad, the inputs in V after the controller's own limits.
    """

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Start anew at rest at these angles."""
        ...

    def step(
        self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float
    ) -> tuple[float, float]:  # u_M_V, u_T_V
        """Take one sample's references and measured angles; return (u_M_V, u_T_V)."""
        ...
