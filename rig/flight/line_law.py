"""The law of a board, stepped through its serial line in host-in-the-loop mode: an execution to compare with the host's."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rig.flight.loop_session import LoopSession
from rig.link.client import BoardClient

Bits = NDArray[np.uint32]


class LineLaw:
    """As verification.stateless.Stateless: angles [lanes, loops] stand for the state. `cycles_max` are by the board's own counter.

    `stepped` is called after each step: they take their time on a slow line.
    """

    name = "board"

    def __init__(self, client: BoardClient, stepped: Callable[[], None] = lambda: None) -> None:
        self.arithmetic = client.numbers.name
        self.cycles_max = 0
        self._client = client
        self._stepped = stepped

    def start(self, angles: Bits) -> Bits:
        """The angles themselves; the board is started when a lane runs."""
        return angles

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """Lane after lane from rest: inputs [steps, lanes, 2 loops] give outputs [steps, lanes, loops], one frame a step each way."""
        lanes = [self._lane(angles, inputs[:, lane]) for lane, angles in enumerate(states)]
        return states, np.stack(lanes, axis=1)

    def _lane(self, angles: Bits, inputs: Bits) -> Bits:
        session = LoopSession(self._client, *self._values(angles))
        return np.array([self._step(session, row) for row in inputs])

    def _step(self, session: LoopSession, row: Bits) -> Bits:
        answer = session.step(tuple(self._values(row)))
        self.cycles_max = max(self.cycles_max, answer.law_cycles)
        self._stepped()
        to_word = self._client.numbers.to_word
        return np.array([to_word(voltage, "V") for voltage in answer.voltages_V], np.uint32)

    def _values(self, words: Bits) -> list[float]:
        return [self._client.numbers.from_word(int(word), "rad") for word in words]
