"""The law inside an image whose chip is not emulated, stepped on that chip's core alone: its bits, but no cycles and no peripherals."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from records.board import Memory
from records.errors import BadInput, VerificationFailed
from records.loops import LOOPS
from rig.programming.image import FirmwareImage

Bits = NDArray[np.uint32]

# Beside the chip's memories: the numbers that go in and come out, and the loop below, which calls the law.
_DESK, _DESK_BYTES = 0x6000_0000, 64 << 20
_PAGE_BYTES = 4096
_ROOM_BYTES = 32  # above the stack
# r7 calls of r8(r4, r5, r6); after each the pointers go on by r9, r10, r11. ARMv6-M.
_CALLS = (
    0x4620, 0x4629, 0x4632,  # mov r0, r4; mov r1, r5; mov r2, r6
    0x47C0,                  # blx r8
    0x444C, 0x4455, 0x445E,  # add r4, r9; add r5, r10; add r6, r11
    0x3F01, 0xD1F6,          # subs r7, #1; bne to the begin
    0xBF00,                  # nop
)  # fmt: skip
_END = 2 * len(_CALLS) - 2
_DATA = _DESK + _PAGE_BYTES


class CoreLaw:
    """`law_reset` and `law_step` of the unmodified image, run by unicorn on the core of the image's chip.

    Raises BadInput where unicorn is not installed.
    """

    name = "target"

    def __init__(self, image: FirmwareImage, arithmetic: str, state_words: int, loops: int = len(LOOPS)) -> None:
        self.arithmetic = arithmetic
        self._image, self._state_words, self._loops = image, state_words, loops
        self._in_float_registers = arithmetic == "float32" and image.board.core.has_float_unit
        self._arm, self._uc, self._fault = _core(image)

    def start(self, angles: Bits) -> Bits:
        """States at rest [lanes, words] for angles as bits [lanes, loops]."""
        return np.array([self._start_lane(lane) for lane in angles.tolist()], dtype=np.uint32)

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes through all steps: inputs [steps, lanes, 2 loops] as bits give final states and outputs [steps, lanes, loops]."""
        if len(inputs) == 1:
            after, outputs = self._steps(states, inputs[0])
            return after, outputs[np.newaxis]
        lanes = [self._steps(state[np.newaxis], inputs[:, lane]) for lane, state in enumerate(states)]
        return np.concatenate([after for after, _ in lanes]), np.stack([outputs for _, outputs in lanes], axis=1)

    def self_test(self) -> int:
        """Mismatches that the emitted self-test finds on the core."""
        self._call("law_self_test", {})
        return int(self._uc.reg_read(self._arm.UC_ARM_REG_R0))

    def _start_lane(self, angles: Sequence[int]) -> Bits:
        self._uc.mem_write(_DATA, bytes(4 * self._state_words))
        stacked = () if self._in_float_registers else angles[3:]
        self._uc.mem_write(_stack_top(self._image), np.array(stacked, np.uint32).tobytes())
        first = 0 if self._in_float_registers else 1
        kind = "S" if self._in_float_registers else "R"
        passed = angles[: len(angles) - len(stacked)]
        self._call("law_reset", {"R0": _DATA, **{f"{kind}{first + k}": bits for k, bits in enumerate(passed)}})
        return self._read(_DATA, self._state_words)

    def _steps(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """A step for each row of `inputs`: each with its own state, or one state through all of them."""
        steps, stride = len(inputs), 4 * self._state_words if len(states) > 1 else 0
        given = _DATA + 4 * states.size
        taken = given + 4 * inputs.size
        self._uc.mem_write(_DATA, np.ascontiguousarray(states).tobytes())
        self._uc.mem_write(given, np.ascontiguousarray(inputs).tobytes())
        step = self._image.symbols["law_step"].address | 1
        values = (_DATA, given, taken, steps, step, stride, 8 * self._loops, 4 * self._loops)
        self._execute(_DESK, {f"R{number}": value for number, value in enumerate(values, start=4)})
        outputs = self._read(taken, steps * self._loops).reshape(steps, self._loops)
        return self._read(_DATA, states.size).reshape(states.shape), outputs

    def _call(self, function: str, registers: Mapping[str, int]) -> None:
        self._execute(self._image.symbols[function].address, {"LR": (_DESK + _END) | 1, **registers})

    def _execute(self, address: int, registers: Mapping[str, int]) -> None:
        """From `address` to the end of the loop; raises VerificationFailed where the core faults."""
        for name, value in {"SP": _stack_top(self._image), **registers}.items():
            self._uc.reg_write(getattr(self._arm, f"UC_ARM_REG_{name}"), value)
        try:
            self._uc.emu_start(address | 1, _DESK + _END)
        except self._fault as error:
            at = self._uc.reg_read(self._arm.UC_ARM_REG_PC)
            raise VerificationFailed(f"the law faults on the core at 0x{at:08x}: {error}") from error

    def _read(self, address: int, words: int) -> Bits:
        return np.frombuffer(bytes(self._uc.mem_read(address, 4 * words)), np.uint32).copy()


def _stack_top(image: FirmwareImage) -> int:
    """Where the stack begins: room above it holds what a call does not pass in registers."""
    return image.symbols["_stack_top"].address - _ROOM_BYTES


def _core(image: FirmwareImage) -> tuple[Any, Any, type[Exception]]:
    """Unicorn's names of registers, its core with the image in the chip's flash, its RAM and the desk, and what it raises."""
    board = image.board
    try:
        import unicorn
        from unicorn import arm_const as arm
    except ImportError as error:
        remedy = "pip install 'unicorn>=2.1'"
        raise BadInput(
            "law on the core", board.chip, "no unicorn", "unicorn, which emulates the core", remedy
        ) from error
    uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
    uc.ctl_set_cpu_model(getattr(arm, f"UC_CPU_ARM_{board.core.unicorn}"))
    for memory in (board.flash, board.ram, Memory(_DESK, _DESK_BYTES)):
        uc.mem_map(memory.start, -(-memory.size_bytes // _PAGE_BYTES) * _PAGE_BYTES)
    uc.mem_write(board.flash.start, image.binary)
    uc.mem_write(_DESK, np.array(_CALLS, np.uint16).tobytes())
    if board.core.has_float_unit:
        uc.reg_write(arm.UC_ARM_REG_FPEXC, 1 << 30)  # what the start-up code does by CPACR
    return arm, uc, unicorn.UcError
