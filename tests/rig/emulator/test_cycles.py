"""Cycles of each instruction class: the Cortex-M0+ table (DDI0484C 3.3), the slower figure where sources disagree."""

import pytest

from records.board import STM32G071
from rig.emulator.board import EmulatedBoard
from tests.rig.emulator.probe import set_registers
from tests.rig.emulator.programs import powered
from tests.rig.emulator.test_oracle import IDLE

FLASH, RAM = STM32G071.flash, STM32G071.ram
PC = FLASH.start + 0x1000
R0, R1, SP = 0x20000100, 4, 0x20007F00
Z_SET = 0x40000000

TABLE = [
    ("movs r0, #1", [0x2001], 1), ("adds r0, r1", [0x1840], 1), ("muls r0, r1", [0x4348], 1), ("lsrs r0, r1", [0x40C8], 1),
    ("mov r8, r0", [0x4680], 1), ("mov pc, lr", [0x46F7], 2), ("add pc, r1", [0x448F], 2), ("sxtb r0, r1", [0xB248], 1),
    ("rev r0, r1", [0xBA08], 1), ("add sp, #8", [0xB002], 1), ("adr r0, .", [0xA000], 1),
    ("ldr r2, [r0]", [0x6802], 2), ("ldrb r2, [r0, r1]", [0x5C42], 2), ("ldr r2, =", [0x4A00], 2), ("ldr r2, [sp]", [0x9A00], 2),
    ("str r2, [r0]", [0x6002], 2), ("strh r2, [r0]", [0x8002], 2),
    ("ldmia r0!, {r1}", [0xC802], 2), ("ldmia r0!, {r1-r7}", [0xC8FE], 8), ("stmia r0!, {r1, r2}", [0xC006], 3),
    ("push {r0-r7}", [0xB4FF], 9), ("push {lr}", [0xB500], 2), ("push {r4-r7, lr}", [0xB5F0], 6),
    ("pop {r0-r7}", [0xBCFF], 9), ("pop {pc}", [0xBD00], 4), ("pop {r4-r7, pc}", [0xBDF0], 8),
    ("beq taken", [0xD000], 2), ("bne not taken", [0xD100], 1), ("b", [0xE000], 2), ("bl", [0xF000, 0xF802], 3),
    ("bx lr", [0x4770], 2), ("blx r3", [0x4798], 2), ("nop", [0xBF00], 1), ("sev", [0xBF40], 1), ("yield", [0xBF10], 1),
    ("cpsid i", [0xB672], 1), ("mrs r0, apsr", [0xF3EF, 0x8000], 3), ("msr apsr, r0", [0xF380, 0x8800], 3),
    ("dsb", [0xF3BF, 0x8F4F], 3), ("dmb", [0xF3BF, 0x8F5F], 3), ("isb", [0xF3BF, 0x8F6F], 3),
]  # fmt: skip


def put(board: EmulatedBoard, halfwords: list[int]) -> None:
    """Place the instruction and give every register it may jump through an address of code."""
    board.write_memory(PC, b"".join(half.to_bytes(2, "little") for half in halfwords))
    board.write_memory(SP, b"".join((PC + 0x101).to_bytes(4, "little") for _ in range(9)))
    registers = [R0, R1, 0, PC + 0x201, 0, 0, 0, 0, 0, 0, 0, 0, 0, SP, PC + 0x301, PC]
    set_registers(board, [*registers, Z_SET])


@pytest.mark.parametrize(("name", "halfwords", "cycles"), TABLE, ids=[row[0] for row in TABLE])
def test_an_instruction_costs_what_the_table_says(name: str, halfwords: list[int], cycles: int) -> None:
    board = powered("idle", IDLE)
    put(board, halfwords)
    stop = board.run_for(1)
    assert not stop.is_fault, str(stop)
    assert (board.instructions, board.cycles) == (1, cycles)


@pytest.mark.parametrize(
    ("halfwords", "stalls"),
    [([0x2001], 0), ([0xD000], 1), ([0xD100], 0), ([0x4770], 1), ([0x4A00], 1), ([0x6802], 0), ([0xF000, 0xF802], 1)],
    ids=["straight on", "taken branch", "branch not taken", "jump", "literal", "load from RAM", "call"],
)
def test_flash_stalls_are_taken_branches_and_data_read_from_flash(halfwords: list[int], stalls: int) -> None:
    board = powered("idle", IDLE)
    put(board, halfwords)
    board.run_for(1)
    assert board.flash_stalls == stalls


@pytest.mark.parametrize("place", [0x20000200, FLASH.start + 0x2000, 0x2000], ids=["SRAM", "flash", "alias of flash"])
def test_code_runs_everywhere_at_the_same_cost_and_a_change_of_it_takes_effect(place: int) -> None:
    board = powered("idle", IDLE)
    for value in (7, 9):  # movs r0, #value; b .
        board.write_memory(place, bytes([value, 0x20, 0xFE, 0xE7]))
        set_registers(board, [0] * 13 + [SP, 0, place, 0])
        before = board.cycles
        board.run_for(3)
        assert board.registers()[0] == value
        assert board.cycles - before == 3
