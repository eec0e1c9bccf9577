"""A board as the controller of a simulated closed loop."""

from collections.abc import Callable

from rig.flight.loop_session import LoopSession
from rig.link.client import BoardClient


class BoardController:
    """The controller interface of sim/loop.py over a board in host-in-the-loop mode: one sample a frame, one answer a frame.

    `law_cycles` are those of the last step, 0 before the first. The board is armed with the first step and not before: it counts
    its host as lost after 0.1 s. `stepped` is called after each step.
    """

    def __init__(self, client: BoardClient, stepped: Callable[[], None] = lambda: None) -> None:
        self._client = client
        self._stepped = stepped
        self._session = LoopSession(client, *[0.0] * len(client.loops))
        self.law_cycles = 0

    def reset(self, *angles_rad: float) -> None:
        """Start anew at rest at these angles, with the next step."""
        self._session = LoopSession(self._client, *angles_rad)

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """One sample through the serial line; returns the voltages. Raises BadInput when the board refuses or is lost."""
        answer = self._session.step(given_rad)
        self.law_cycles = answer.law_cycles
        self._stepped()
        return answer.voltages_V
