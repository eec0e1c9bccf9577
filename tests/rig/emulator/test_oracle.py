"""The core against unicorn: random single instructions of all classes, registers, flags and memory."""

import numpy as np
import pytest

from records.board import STM32G071
from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import StopKind
from tests.rig.emulator.oracle import Oracle, board_step
from tests.rig.emulator.programs import build, powered
from tests.rig.emulator.thumb import (
    CLASSES,
    HIGH_CLASSES,
    LONG_CLASSES,
    Instruction,
    random_instruction,
    random_registers,
)
from tests.soak import SOAK, sampled

FLASH, RAM = STM32G071.flash, STM32G071.ram
# 220 800 instructions in a soak, 3 000 else; some 7 % are unaligned accesses.
SHARDS, SLOTS, VISITS = range(4), *((6900, 8) if SOAK else (3000, 1))
FIRST = 0x10000  # the middle of flash, so that all branches stay inside
STRIDE = 8
SOFT = """
__attribute__((used, noinline)) float scale(uint32_t a, uint32_t b) {
    union { uint32_t word; float value; } x = {a}, y = {b};
    return (x.value + y.value) / (x.value * y.value - 0.3f);
}
__attribute__((used, noinline)) int32_t divide(int32_t a, int32_t b) { return b ? a / b : a; }
__attribute__((used, noinline)) int32_t product(int32_t a, int32_t b) { return (int32_t)(((int64_t)a * b) >> 27); }
void Reset_Handler(void) { for (;;) {} }
VECTORS(0);
"""
IDLE = "void Reset_Handler(void) { for (;;) {} }\nVECTORS(0);"


def laid_out(rng: np.random.Generator) -> tuple[bytes, list[Instruction]]:
    """Flash with one random instruction at every eighth byte from the middle on, and NOPs elsewhere."""
    flash = bytearray(b"\x00\xbf" * 0x10000)
    instructions = [random_instruction(rng) for _ in range(SLOTS)]
    for slot, instruction in enumerate(instructions):
        for k, half in enumerate(instruction.halfwords):
            at = FIRST + STRIDE * slot + 2 * k
            flash[at : at + 2] = half.to_bytes(2, "little")
    return bytes(flash), instructions


def fresh_board(flash: bytes) -> EmulatedBoard:
    board = EmulatedBoard(build("idle", IDLE), BoardConfig(check_stack_limit=False))
    board.write_memory(FLASH.start, flash)
    return board


def told(instruction: Instruction, registers: list[int], xpsr: int) -> str:
    return f"{instruction.kind} {[hex(h) for h in instruction.halfwords]} with {[hex(r) for r in registers]} {xpsr:#x}"


@pytest.mark.parametrize("shard", sampled(SHARDS, keep=[0]))
def test_random_instructions_leave_the_same_registers_flags_and_memory_as_unicorn(shard: int) -> None:
    rng = np.random.default_rng(7100 + shard)
    flash, instructions = laid_out(rng)
    memory = rng.bytes(RAM.size_bytes)
    board, oracle = fresh_board(flash), Oracle(flash)
    board.write_memory(RAM.start, memory)
    oracle.uc.mem_write(RAM.start, memory)
    executed: dict[str, int] = {}
    compared = 0
    for _ in range(VISITS):
        rows, flags = random_registers(rng, SLOTS), rng.integers(0, 16, SLOTS).tolist()
        for slot, instruction in enumerate(instructions):
            registers, xpsr = [*rows[slot], FLASH.start + FIRST + STRIDE * slot], flags[slot] << 28
            if instruction.kind == "msr":  # unicorn keeps the low bits of a stack pointer, the architecture does not
                registers = [value & ~3 for value in registers]
            ours, stop = board_step(board, registers, xpsr)
            if stop.kind == StopKind.UNALIGNED:  # unicorn lets it pass, ARMv6-M does not (DDI0419 A3.2)
                assert stop.address % stop.detail
                continue
            compared += 1
            theirs = oracle.step(registers, xpsr)
            assert ours == theirs, told(instruction, registers, xpsr)
            executed[instruction.kind] = executed.get(instruction.kind, 0) + (not ours.faulted)
        assert board.read_memory(RAM.start, RAM.size_bytes) == oracle.sram()
    assert compared >= 0.9 * SLOTS * VISITS
    assert set(executed) == {*CLASSES, *HIGH_CLASSES, *LONG_CLASSES}
    assert min(executed.values()) > SLOTS // 575 * VISITS, executed


@pytest.mark.parametrize("name", ["scale", "divide", "product"])
def test_compiled_functions_of_soft_arithmetic_return_the_same_words_as_in_unicorn(name: str) -> None:
    board = powered("soft", SOFT)
    oracle = Oracle(board.image.flash)
    words = np.random.default_rng(7).integers(0, 2**32, (300, 2)).tolist()
    corners = [0, 1, 0x7F800000, 0xFF800000, 0x7FC00000, 0x00800000, 0x007FFFFF, 0x80000000, 0x3F800000, 0xFFFFFFFF]
    for first, second in [*words, *[(a, b) for a in corners for b in corners]]:
        ours = board.call(name, first, second).result
        assert ours == oracle.call(board.symbol(name)[0], [first, second]), (name, hex(first), hex(second))
