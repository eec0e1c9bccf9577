"""The law inside the firmware image, stepped on the emulated board: an execution to compare with twin and host, and what it costs."""

import numpy as np
from numpy.typing import NDArray

from codegen.law_equations import axis_state
from codegen.law_frame import state_size
from records.loops import LOOPS, Loop
from rig.emulator.answers import CallsResult
from rig.emulator.bench import Speed, measure
from rig.emulator.board import EmulatedBoard
from rig.link.numbers import Numbers

Bits = NDArray[np.uint32]

STATE_WORDS = state_size(axis_state(3), len(LOOPS))  # of the scheduled law of the helicopter


class TargetLaw:
    """`law_reset` and `law_step` of the unmodified image, called one step at a time with interrupts off.

    `cycles_max` (flash without wait states) and `stack_bytes` are the largest over all steps so far.
    """

    name = "target"

    def __init__(
        self,
        board: EmulatedBoard,
        arithmetic: str = "float32",
        state_words: int = STATE_WORDS,
        loops: tuple[Loop, ...] = LOOPS,
    ) -> None:
        self.arithmetic = arithmetic
        self._output_bytes = 4 * len(loops)
        self._state_bytes = 4 * state_words
        self.cycles_max = 0
        self.cycles_min = 2**63
        self.stack_bytes = 0
        self._board = board
        self._state = board.scratch_address()
        self._input = self._state + self._state_bytes
        self._output = self._input + 8 * len(loops)

    def start(self, angles: Bits) -> Bits:
        """States at rest [lanes, words] for angles as bits [lanes, loops]."""
        return np.array([self._start_lane(*lane) for lane in angles.tolist()], dtype=np.uint32)

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes through all steps: inputs [steps, lanes, 2 loops] as bits give final states and outputs [steps, lanes, loops]."""
        if len(inputs) == 1:
            return self._one_step(states, inputs)
        lanes = [self._run_lane(state, inputs[:, lane]) for lane, state in enumerate(states)]
        return np.array([state for state, _ in lanes]), np.stack([outputs for _, outputs in lanes], axis=1)

    def self_test(self) -> int:
        """Mismatches that the emitted self-test finds on the target."""
        return self._board.call("law_self_test").result

    def speed(self, steps: int, numbers: Numbers) -> Speed:
        """How fast the board steps the law, both axes on their way to a reference; its memory goes on from call to call."""
        given = [numbers.to_word(angle_rad, "rad") for angle_rad in (0.3, 0.4, 0.1, -0.2)]
        self._start_lane(*given[2:])
        self._board.write_memory(self._input, np.array(given, np.uint32).tobytes())
        return measure(self._board, "law_step", (self._state, self._input, self._output), steps)

    def table_digest(self) -> str:
        """The digest in the image's flash."""
        address, size = self._board.symbol("LAW_TABLE_DIGEST")
        return self._board.read_memory(address, size).hex()

    def _start_lane(self, *angles: int) -> Bits:
        self._board.write_memory(self._state, bytes(self._state_bytes))
        self._board.call("law_reset", self._state, *angles)
        return self._read_state()

    def _run_lane(self, state: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """One lane: the state stays in the board's memory from step to step."""
        self._board.write_memory(self._state, np.ascontiguousarray(state).tobytes())
        done = self._call([(self._input, inputs)], [(self._output, self._output_bytes)], len(inputs))
        return self._read_state(), done.outputs[0].view(np.uint32)

    def _one_step(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes in one batch, each with its own state."""
        rows = [(self._state, states), (self._input, inputs[0])]
        wells = [(self._state, self._state_bytes), (self._output, self._output_bytes)]
        done = self._call(rows, wells, len(states))
        return done.outputs[0].view(np.uint32), done.outputs[1].view(np.uint32)[np.newaxis]

    def _call(self, rows: list[tuple[int, Bits]], wells: list[tuple[int, int]], steps: int) -> CallsResult:
        arguments = (self._state, self._input, self._output)
        done = self._board.call_many("law_step", arguments, rows, wells, steps)
        self.cycles_max = max(self.cycles_max, done.cycles_max)
        self.cycles_min = min(self.cycles_min, done.cycles_min)
        self.stack_bytes = max(self.stack_bytes, done.stack_bytes)
        return done

    def _read_state(self) -> Bits:
        return np.frombuffer(self._board.read_memory(self._state, self._state_bytes), np.uint32).copy()
