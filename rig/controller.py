"""A board as the controller of a simulated closed loop."""

from rig.client import BoardClient


class BoardController:
    """The controller interface of sim/loop.py over a board in host-in-the-loop mode: one sample a frame, one answer a frame.

    The board is armed at the first `reset`. `law_cycles` are those of the last step, 0 before the first.
    """

    def __init__(self, client: BoardClient) -> None:
        self._client = client
        self.law_cycles = 0

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Arm the board, where it is not armed yet, and start its law at rest at these angles."""
        self._client.arm("LOOP")
        self._client.reset_law(psi_rad, phi_rad)

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]:
        """One sample through the serial line; returns (u_M_V, u_T_V). Raises BadInput when the board is lost."""
        answer = self._client.sample(psi_ref_rad, phi_ref_rad, psi_rad, phi_rad)
        self.law_cycles = answer.law_cycles
        return answer.u_M_V, answer.u_T_V
