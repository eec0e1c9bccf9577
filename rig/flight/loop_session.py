"""The law of a board in host-in-the-loop mode, stepped from rest; a host that was too slow for the board begins again.

The board counts its host as lost when 0.1 s pass without a sample, and a computer that is busy may need longer. The law's steps
depend on what it was given since its reset and on nothing else, so that the same samples, sent again from the reset on, bring it to
the same state: what comes out is the same whatever the computer does meanwhile.
"""

from rig.link.client import BoardClient, Refused
from rig.link.replies import Answer

Given = tuple[float, ...]

ATTEMPTS = 20


class LoopSession:
    """Samples since the law's reset at its angles; `losses` counts how often the board had given its host up."""

    def __init__(self, client: BoardClient, *angles_rad: float) -> None:
        self.losses = 0
        self._client = client
        self._start_rad = angles_rad
        self._given: list[Given] = []
        self._is_armed = False

    def step(self, given: Given) -> Answer:
        """One step of the law; raises BadInput when the board refuses, or loses its host again and again."""
        self._given.append(given)
        for _ in range(ATTEMPTS - 1):
            try:
                return self._last()
            except Refused as refusal:
                # A board that has not lost its host and is not armed was reset: that is no pause of the computer.
                if refusal.reason != "NOT_ARMED" or not self._client.counters()["host_losses"]:
                    raise
                self._is_armed = False
                self.losses += 1
        return self._last()

    def _last(self) -> Answer:
        """The answer to the last sample; where the board has to be armed first, to all of them in turn."""
        if self._is_armed:
            return self._client.sample(*self._given[-1])
        self._client.arm("LOOP")
        self._client.reset_law(*self._start_rad)
        answers = [self._client.sample(*given) for given in self._given]
        self._is_armed = True
        return answers[-1]
