"""How fast the emulated core is on this computer, everything counted."""

import time
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


def measure(board: EmulatedBoard, cycles: int = 400_000_000) -> Speed:
    """Run the board for `cycles` with coverage, cycle, stack and exception counting on, as always."""
    instructions, begin = board.instructions, board.cycles
    cpu_s = time.process_time()
    board.run_for(cycles)
    return Speed(board.instructions - instructions, board.cycles - begin, max(time.process_time() - cpu_s, 1e-9))
