"""The law as a board on a line shows it: started at angles, stepped, but never asked for its state."""

import numpy as np
from numpy.typing import NDArray

from verification.equality import BatchStepper

Bits = NDArray[np.uint32]


class Stateless:
    """An execution whose states stay hidden: what stands for a state is the angles it was started at."""

    def __init__(self, law: BatchStepper) -> None:
        self.name, self.arithmetic = law.name, law.arithmetic
        self._law = law

    def start(self, angles: Bits) -> Bits:
        """The angles themselves."""
        return angles

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """From rest at the angles `states` through all inputs."""
        return states, self._law.run(self._law.start(states), inputs)[1]
