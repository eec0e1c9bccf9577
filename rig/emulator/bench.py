"""How fast the emulated core is on this computer, with everything counted."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

from rig.emulator.board import EmulatedBoard


@dataclass(frozen=True)
class Speed:
    """Instructions and cycles that the board executed in so much CPU time."""

    instructions: int
    cycles: int
    cpu_s: float

    @property
    def instructions_per_s(self) -> float:
        """Instructions per second of CPU time."""
        return self.instructions / self.cpu_s


def measure(board: EmulatedBoard, name: str, arguments: Sequence[int], steps: int) -> Speed:
    """Call a function of the image `steps` times; cycles, coverage, stack and exceptions are counted as always."""
    begin_s = time.process_time()
    done = board.call_many(name, arguments, [], [], steps)
    return Speed(done.instructions, done.cycles_sum, max(time.process_time() - begin_s, 1e-9))
