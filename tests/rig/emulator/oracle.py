"""The independent oracle: the same instruction with the same registers in unicorn and in the emulated board."""

from collections.abc import Sequence
from dataclasses import dataclass

import unicorn
from unicorn import arm_const as arm

from records.board import STM32G071
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import Stop
from tests.rig.emulator.probe import set_registers

FLASH, RAM = STM32G071.flash, STM32G071.ram
GENERAL = [getattr(arm, f"UC_ARM_REG_R{i}") for i in range(13)] + [
    arm.UC_ARM_REG_SP,
    arm.UC_ARM_REG_LR,
    arm.UC_ARM_REG_PC,
]
SPECIAL = [arm.UC_ARM_REG_XPSR, arm.UC_ARM_REG_PRIMASK, arm.UC_ARM_REG_CONTROL, arm.UC_ARM_REG_MSP, arm.UC_ARM_REG_PSP]
FLAGS = 0xF0000000
SP = 13
NOWHERE = 0xFFFFFFF0


@dataclass(frozen=True)
class Outcome:
    """State after one instruction, or the fact that it faulted."""

    faulted: bool
    registers: tuple[int, ...] = ()


class Oracle:
    """Unicorn's Cortex-M0 with flash and SRAM where the board has them."""

    def __init__(self, flash: bytes) -> None:
        self.uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M0)
        self.uc.mem_map(FLASH.start, FLASH.size_bytes, unicorn.UC_PROT_READ | unicorn.UC_PROT_EXEC)
        self.uc.mem_map(RAM.start, RAM.size_bytes)
        self.uc.mem_map(0, FLASH.size_bytes, unicorn.UC_PROT_READ | unicorn.UC_PROT_EXEC)  # the alias
        self.uc.mem_write(FLASH.start, flash)
        self.uc.mem_write(0, flash)

    def sram(self) -> bytes:
        """The whole SRAM."""
        return bytes(self.uc.mem_read(RAM.start, RAM.size_bytes))

    def step(self, registers: Sequence[int], xpsr: int) -> Outcome:
        """Execute the instruction at registers[15]."""
        self.uc.reg_write_batch(list(zip(GENERAL, registers, strict=True)))
        self.uc.reg_write(arm.UC_ARM_REG_XPSR, xpsr | 1 << 24)
        try:
            self.uc.emu_start(registers[15] | 1, NOWHERE, count=1)
        except unicorn.UcError:
            return Outcome(True)
        after = self.uc.reg_read_batch(GENERAL + SPECIAL)
        return Outcome(False, normal(after))

    def call(self, address: int, arguments: Sequence[int]) -> int:
        """r0 after a whole function."""
        back = FLASH.end - 16
        registers = [*arguments, *[0] * (13 - len(arguments)), RAM.end, back | 1, address]
        self.uc.reg_write_batch(list(zip(GENERAL, registers, strict=True)))
        self.uc.emu_start(address | 1, back)
        return int(self.uc.reg_read(GENERAL[0]))


def normal(after: Sequence[int]) -> tuple[int, ...]:
    """Comparable form: flags only of xPSR; SP, MSP and PSP without the two low bits, which unicorn wrongly keeps."""
    values = [value & 0xFFFFFFFF for value in after]
    for index in (SP, 19, 20):
        values[index] &= ~3
    values[16] &= FLAGS
    return tuple(values)


def is_code(address: int) -> bool:
    """Whether instructions can be fetched there."""
    return any(
        0 <= address - base < size
        for base, size in (
            (0, FLASH.size_bytes),
            (FLASH.start, FLASH.size_bytes),
            (RAM.start, RAM.size_bytes),
        )
    )


def board_step(board: EmulatedBoard, registers: Sequence[int], xpsr: int) -> tuple[Outcome, Stop]:
    """The same on the emulated board; a branch out of all code faults at once in unicorn, so it counts as a fault here too."""
    set_registers(board, [*registers, xpsr])
    stop = board.run_for(1)
    after = board.registers()
    return Outcome(True) if stop.is_fault or not is_code(after[15]) else Outcome(False, normal(after)), stop
