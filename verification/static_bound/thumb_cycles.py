"""Cycles of each Thumb instruction on a Cortex-M0+ with the single-cycle multiplier (DDI0484C table 3-1), and its flash stalls."""

from typing import NamedTuple

from records.board import STM32G071
from verification.static_bound.thumb import LOADS, PC, SP, STORES, Instruction

FLASH_LINE_BYTES = 8
WAIT_STATES = STM32G071.flash_wait_states


class Cycles(NamedTuple):
    """Cycles without wait states, and with the two of 64 MHz."""

    zero_wait: int
    two_wait: int

    def plus(self, other: "Cycles") -> "Cycles":
        """Both one after the other."""
        return Cycles(self.zero_wait + other.zero_wait, self.two_wait + other.two_wait)

    def most(self, other: "Cycles") -> "Cycles":
        """The larger of each figure; they may belong to different paths."""
        return Cycles(max(self.zero_wait, other.zero_wait), max(self.two_wait, other.two_wait))


NO_CYCLES = Cycles(0, 0)
_TWO = frozenset({"bx", "blx", "b", "b_if", "mov_pc", "add_pc"}) | LOADS | STORES | {"ldr_literal"}
_THREE = frozenset({"bl", "msr", "mrs", "barrier"})
_MULTIPLE = frozenset({"push", "pop", "ldm", "stm"})


def instruction_cycles(instruction: Instruction) -> int:
    """Cycles at zero wait states; a conditional branch counts as taken.

    Where sources disagree the slower count stands: PUSH with lr 1 + N, POP with pc 3 + N, N counting lr or pc.
    """
    if instruction.op in _MULTIPLE:
        return len(instruction.registers) + (3 if PC in instruction.registers else 1)
    if instruction.op in _TWO:
        return 2
    return 3 if instruction.op in _THREE else 1


def jump_stalls(target: int) -> int:
    """Most wait states that a jump to `target` costs.

    A prefetch in flight must end (2), the target's 64-bit line is read (2); unless the target begins that line, its successor may be
    wanted before the prefetch has it (2). Straight code costs none: a line holds four halfwords, four cycles of work or more, and the
    prefetch buffer has the next line after three.
    """
    return WAIT_STATES * (2 if target % FLASH_LINE_BYTES == 0 else 3)


def data_stalls(instruction: Instruction, may_read_flash: bool) -> int:
    """Most wait states of a data access.

    For each word read from flash a prefetch must end (2), the word is read (2), the prefetch begins anew (2).
    """
    if instruction.op == "ldr_literal":
        return 3 * WAIT_STATES
    if instruction.op in LOADS and instruction.n != SP and may_read_flash:
        return 3 * WAIT_STATES
    return 3 * WAIT_STATES * len(instruction.registers) if instruction.op == "ldm" and may_read_flash else 0
