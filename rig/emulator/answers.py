"""What the emulated board answers to its host: small frozen records."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.board import STM32G071, Board
from records.errors import BadInput
from rig.emulator.stops import Stop


@dataclass(frozen=True)
class BoardConfig:
    """How the board is set up: which chip, serial speed of the host's end, what ends a run, the chip's unique id."""

    host_baud: int = 921_600
    stop_on_fault: bool = True
    stop_on_reset: bool = False
    check_stack_limit: bool = True
    unique_id: tuple[int, int, int] = (0x00470031, 0x3037470A, 0x20363542)
    chip: Board = STM32G071


@dataclass(frozen=True)
class CallResult:
    """What one call of a target function gave and cost; `cycles_flash` adds the estimate for the flash's wait states."""

    result: int
    cycles: int
    cycles_flash: int
    instructions: int
    stack_bytes: int


@dataclass(frozen=True)
class CallsResult:
    """A batch of calls: r0 and cycles of each step, the output blocks (one row a step), and the totals."""

    results: NDArray[np.uint32]
    cycles: NDArray[np.uint64]
    outputs: tuple[NDArray[np.uint8], ...]
    instructions: int
    stack_bytes: int

    @property
    def cycles_min(self) -> int:
        """Cycles of the fastest step."""
        return int(self.cycles.min())

    @property
    def cycles_max(self) -> int:
        """Cycles of the slowest step."""
        return int(self.cycles.max())

    @property
    def cycles_sum(self) -> int:
        """Cycles of all steps."""
        return int(self.cycles.sum())


@dataclass(frozen=True)
class Pwm:
    """TIM1: compare values in ticks of a period of ARR + 1, which channels are on, and whether MOE lets them out."""

    main_ticks: int
    tail_ticks: int
    period_ticks: int
    enabled: bool
    channels_enabled: tuple[bool, bool]


@dataclass(frozen=True)
class Gpio:
    """A port: two mode bits a pin (0 input, 1 output, 2 alternate, 3 analog) and the output latch."""

    mode: int
    output: int

    def drives(self, pin: int) -> bool | None:
        """Level that the pin drives as an output, None when it is no output."""
        return bool(self.output >> pin & 1) if self.mode >> 2 * pin & 3 == 1 else None


@dataclass(frozen=True)
class Reset:
    """A reset of the board: `power`, `pin`, `software` or `watchdog`, and when."""

    cause: str
    time_s: float


class StoppedError(RuntimeError):
    """A function called on the board did not return; `stop` says why."""

    def __init__(self, stop: Stop) -> None:
        super().__init__(str(stop))
        self.stop = stop


def no_symbol(where: str, name: str) -> BadInput:
    """What is wrong with a name that the image has not."""
    expected, remedy = "a symbol of the image", "build the image with its symbol table"
    return BadInput("symbol", where, f"no `{name}`", expected, remedy)


def no_memory(address: int, size: int) -> BadInput:
    """What is wrong with an access outside flash and SRAM."""
    return BadInput(
        "memory access",
        "emulated board",
        f"{size} bytes at 0x{address:08x}",
        "a range inside flash or SRAM",
        "check the address",
    )
