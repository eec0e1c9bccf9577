"""Peripherals of a few registers: interrupt controller, pins, the chip's identity."""

from rig.emulator.answers import BoardConfig
from tests.rig.emulator.probe import drive_pin
from tests.rig.emulator.programs import powered, stopped, word

NVIC = """
volatile uint32_t ticks, seen[8];
void tick(void) { ticks++; }
void Reset_Handler(void) {
    REG(0xE000E200) = 5u << 16; /* interrupts 16 and 18 pending, neither enabled */
    seen[0] = REG(0xE000E200);
    REG(0xE000E280) = 1u << 16;
    seen[1] = REG(0xE000E280);
    REG(0xE000E100) = 3u << 20;
    REG(0xE000E180) = 1u << 20;
    seen[2] = REG(0xE000E100);
    REG(0xE000E410) = 0xFFFFFFFF;
    seen[3] = REG(0xE000E410);
    seen[4] = REG(0xE000ED04) >> 12 & 0x1FF;
    REG(0xE000ED1C) = REG(0xE000ED20) = 0xFFFFFFFF;
    seen[5] = REG(0xE000ED1C);
    seen[6] = REG(0xE000ED20);
    seen[7] = REG(0xE000ED00);
    STOP();
}
VECTORS([16 + 18] = tick);
"""


def test_the_interrupt_controllers_registers_set_clear_and_hold_two_priority_bits() -> None:
    board = stopped("nvic", NVIC)
    seen = [word(board, "seen", i) for i in range(8)]
    cpu_id = 0x410CC601
    assert seen == [5 << 16, 4 << 16, 2 << 20, 0xC0C0C0C0, 0, 0xC0000000, 0xC0C00000, cpu_id]
    assert word(board, "ticks") == 0


def test_pins_follow_their_latch_and_read_what_the_host_drives() -> None:
    source = """
    volatile uint32_t in[3];
    void Reset_Handler(void) {
        REG(0x40021034) = 7;
        REG(0x50000400) = 1u << 2 * 3;
        REG(0x50000418) = 1u << 3 | 1u << 7;
        in[0] = REG(0x50000410);
        REG(0x50000418) = 1u << (16 + 3);
        in[1] = REG(0x50000410);
        *(volatile uint16_t *)0x50000414 = 0x8008;
        in[2] = REG(0x50000414);
        STOP();
    }
    VECTORS(0);
    """
    board = powered("pins", source)
    drive_pin(board, "B", 1, True)
    board.run_for(1000)
    assert [word(board, "in", i) for i in range(3)] == [1 << 3 | 1 << 1, 1 << 1, 0x8008]
    assert board.gpio("B").drives(3) is True
    assert board.gpio("B").drives(4) is None


def test_the_unique_id_is_the_configured_one() -> None:
    source = "volatile uint32_t id[3];\n"
    source += (
        "void Reset_Handler(void) { for (int i = 0; i < 3; i++) id[i] = REG(0x1FFF7590 + 4 * i); STOP(); } VECTORS(0);"
    )
    board = powered("identity", source, BoardConfig(unique_id=(1, 2, 3)))
    board.run_for(1000)
    assert [word(board, "id", i) for i in range(3)] == [1, 2, 3]
