"""USART2 on a line with true bit times: pace, order, overrun, framing, noise, interrupts."""

from itertools import pairwise

import numpy as np
import pytest

from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import StopKind
from tests.rig.emulator.probe import exception_counts, received_bytes
from tests.rig.emulator.programs import powered, word

FRAME_BITS = 10
BRR = 69
BOARD_BYTE_S = FRAME_BITS * BRR / 64e6
HOST_BYTE_S = FRAME_BITS / 921_600

START = """
static void usart_start(uint32_t cr1) {
    clock_64_mhz();
    REG(0x4002103C) = 1u << 17;
    REG(0x4000440C) = 69;
    REG(0x40004400) = cr1;
}
#define ISR REG(0x4000441C)
#define ICR REG(0x40004420)
#define RDR REG(0x40004424)
#define TDR REG(0x40004428)
volatile uint32_t got[64], flags[64], count;
"""
ECHO = """
void usart(void) {
    flags[count] = ISR;
    ICR = 0xE;
    if (flags[count] & 0x20) got[count] = RDR, TDR = got[count] + 1;
    count++;
}
void Reset_Handler(void) {
    count = 0;
    usart_start(1 | 4 | 8 | 0x20);
    REG(0xE000E100) = 1u << 28;
    for (;;) __asm volatile("wfi");
}
VECTORS([16 + 28] = usart);
"""
LISTENER = """
volatile uint32_t go;
void Reset_Handler(void) {
    usart_start(1 | 4);
    while (!go) {}
    flags[0] = ISR;
    got[0] = RDR;
    flags[1] = ISR;
    ICR = 8;
    flags[2] = ISR;
    got[1] = RDR;
    STOP();
}
VECTORS(0);
"""
SENDER = """
void Reset_Handler(void) {
    usart_start(1 | 8);
    flags[0] = ISR;
    TDR = 0x55;
    flags[1] = ISR;
    TDR = 0xAA;
    flags[2] = ISR;
    while (!(ISR & 0x80)) {}
    flags[3] = ISR;
    TDR = 0x0F;
    while (!(ISR & 0x40)) {}
    flags[4] = ISR;
    STOP();
}
VECTORS(0);
"""
TXE, TC, RXNE, ORE, FE, NE = 0x80, 0x40, 0x20, 8, 2, 4


def started(name: str, source: str, config: BoardConfig | None = None) -> EmulatedBoard:
    board = powered(name, START + source, config)
    board.run_until_s(1e-3)
    return board


def test_bytes_come_back_in_order_one_frame_of_ten_bits_apart() -> None:
    board = started("echo", ECHO)
    begin = board.time_s
    board.uart_write(bytes(range(20)))
    board.run_until_s(begin + 22 * BOARD_BYTE_S + 1e-5)
    answer = received_bytes(board)
    assert [byte.value for byte in answer] == list(range(1, 21))
    assert answer[0].end_s == pytest.approx(begin + HOST_BYTE_S + BOARD_BYTE_S, abs=2e-6)
    gaps = [after.end_s - before.end_s for before, after in pairwise(answer)]
    assert gaps == pytest.approx([HOST_BYTE_S] * 19, abs=1e-6)


def test_no_byte_is_lost_at_full_speed_in_both_directions() -> None:
    board = started("echo", ECHO.replace("got[count]", "got[0]").replace("flags[count]", "flags[0]"))
    message = bytes(k * 7 & 0x7F for k in range(5000))
    board.uart_write(message)
    board.run_until_bytes(5000, 1.0)
    assert board.uart_read() == bytes(byte + 1 for byte in message)


def test_a_byte_that_meets_an_unread_one_is_lost_and_tells_overrun() -> None:
    board = started("listener", LISTENER)
    board.uart_write(b"ABC")
    board.run_until_s(board.time_s + 4 * HOST_BYTE_S)
    board.write_memory(board.symbol("go")[0], b"\x01")
    assert board.run_for(10_000).kind == StopKind.BREAKPOINT
    before, after_read, cleared = (word(board, "flags", i) & (RXNE | ORE | FE | NE) for i in range(3))
    assert (before, after_read, cleared) == (RXNE | ORE, ORE, 0)
    assert word(board, "got", 0) == ord("A")


def test_status_follows_data_and_shift_register() -> None:
    board = powered("sender", START + SENDER)
    assert board.run_for(100_000).kind == StopKind.BREAKPOINT
    seen = [word(board, "flags", i) & (TXE | TC) for i in range(5)]
    # Idle; first byte at once in the shift register; second waits; room again; all gone.
    assert seen == [TXE | TC, TXE, 0, TXE, TXE | TC]
    received = received_bytes(board)
    assert [byte.value for byte in received] == [0x55, 0xAA, 0x0F]
    assert received[2].end_s - received[0].end_s == pytest.approx(2 * BOARD_BYTE_S, rel=0.01)


@pytest.mark.parametrize("ratio", [0.97, 0.985, 1.0, 1.015, 1.03])
def test_speeds_three_percent_apart_are_still_understood(ratio: float) -> None:
    board = started("echo", ECHO, BoardConfig(host_baud=round(927_536 * ratio)))
    board.uart_write(b"\x00Uq\x7e")
    board.run_until_s(board.time_s + 1e-3)
    assert board.uart_read() == b"\x01Vr\x7f"


@pytest.mark.parametrize("baud", [115_200, 460_800, 1_000_000, 1_843_200])
def test_other_speeds_give_garbage_or_errors_never_the_message(baud: int) -> None:
    board = started("echo", ECHO, BoardConfig(host_baud=baud))
    board.uart_write(b"The quick")
    board.run_until_s(board.time_s + 2e-3)
    received = bytes(word(board, "got", i) & 0xFF for i in range(word(board, "count")))
    errors = [word(board, "flags", i) & (FE | NE) for i in range(word(board, "count"))]
    assert received != b"The quick"
    assert any(errors)


def test_a_receiver_that_is_off_hears_nothing_and_starts_with_the_next_byte() -> None:
    board = powered("echo", START + ECHO)
    board.uart_write(b"early")
    board.uart_write(b"late", earliest_s=1e-3)
    board.run_until_s(2e-3)
    assert board.uart_read()[-4:] == b"mbuf"


@pytest.mark.parametrize(
    "feature", ["0x40004400) = 1u << 29", "0x40004400) = 1u << 12", "0x40004408) = 1u << 6", "0x40004404) = 1u << 13"]
)
def test_features_that_are_not_modelled_stop_with_the_register_named(feature: str) -> None:
    source = f"void Reset_Handler(void) {{ usart_start(0); REG({feature}; STOP(); }} VECTORS(0);"
    stop = powered("feature", START + source).run_for(1000)
    assert stop.kind == StopKind.UNMODELLED
    assert feature[:10] in stop.message


BUSY_ECHO = (
    ECHO.replace('__asm volatile("wfi");', "count = count;")
    .replace("got[count]", "got[0]")
    .replace("flags[count]", "flags[0]")
)


@pytest.mark.parametrize("source", [ECHO, BUSY_ECHO], ids=["asleep between bytes", "always awake"])
def test_what_happens_does_not_depend_on_how_a_run_is_cut_into_slices(source: str) -> None:
    def final(slices: int) -> tuple[object, ...]:
        board = powered(f"slices{len(source)}", START + source)
        board.uart_write(b"0123456789", earliest_s=1e-3)
        rng = np.random.default_rng(slices)
        for t_s in sorted(rng.uniform(0, 2e-3, slices)):
            board.run_until_s(t_s)
        board.run_until_s(2e-3)
        return board.registers(), board.cycles, board.instructions, received_bytes(board), exception_counts(board)

    whole = final(0)
    assert len(whole[3]) == 10  # type: ignore[arg-type]
    assert final(700) == whole
