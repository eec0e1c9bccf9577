"""The clock tree: reset, PLL, flash wait states, prescalers."""

import pytest

from rig.emulator.stops import StopKind
from tests.rig.emulator.programs import powered, stopped, word


def test_the_core_runs_at_16_mhz_after_reset_and_at_64_from_the_pll() -> None:
    board = powered("clock", "void Reset_Handler(void) { clock_64_mhz(); STOP(); } VECTORS(0);")
    assert board.clock_hz == 16_000_000
    board.run_for(1000)
    assert board.clock_hz == 64_000_000
    before_s, before = board.time_s, board.cycles
    source = "void Reset_Handler(void) { clock_64_mhz(); for (;;) {} } VECTORS(0);"
    board = powered("clock_loop", source)
    board.run_for(1000)
    before_s, before = board.time_s, board.cycles
    board.run_for(64_000)
    assert board.time_s - before_s == pytest.approx((board.cycles - before) / 64e6, abs=1e-12)
    assert board.time_s - before_s == pytest.approx(1e-3, abs=1e-7)


def test_64_mhz_without_flash_wait_states_is_refused() -> None:
    source = "void Reset_Handler(void) { clock_64_mhz(); REG(0x40022000) = 0; STOP(); } VECTORS(0);"
    stop = powered("latency", source).run_for(1000)
    assert stop.kind == StopKind.FLASH_LATENCY
    assert "64000000" in stop.message


def test_a_pll_that_runs_cannot_be_set_and_one_in_use_cannot_be_stopped() -> None:
    source = """
    volatile uint32_t running, after, setting;
    void Reset_Handler(void) {
        clock_64_mhz();
        REG(0x4002100C) = 2u | 16u << 8 | 1u << 28 | 7u << 29;
        REG(0x40021000) &= ~(1u << 24);
        running = REG(0x40021000) >> 24 & 3u;
        setting = REG(0x4002100C);
        REG(0x40021008) = 0;
        REG(0x40021000) &= ~(1u << 24);
        after = REG(0x40021000) >> 24 & 3u;
        STOP();
    }
    VECTORS(0);
    """
    board = stopped("pll", source)
    assert word(board, "setting") == 2 | 8 << 8 | 1 << 28 | 1 << 29
    assert (word(board, "running"), word(board, "after"), board.clock_hz) == (3, 0, 16_000_000)


def test_prescalers_divide_core_and_timer_clock() -> None:
    source = """
    volatile uint32_t first, second;
    void Reset_Handler(void) {
        REG(0x4002103C) = 1u << 4;
        REG(0x40021008) = 5u << 12; /* APB / 4: timers run at half the core clock */
        REG(0x40001000) = 1;
        first = REG(0x40001024);
        for (int i = 0; i < 100; i++) __asm volatile("nop");
        second = REG(0x40001024);
        REG(0x40021008) = 9u << 8; /* AHB / 4 */
        STOP();
    }
    VECTORS(0);
    """
    board = stopped("prescalers", source)
    assert board.clock_hz == 4_000_000
    # 100 turns of nop, subtract, taken branch: 4 cycles each, half as many counts
    assert word(board, "second") - word(board, "first") == pytest.approx(200, abs=8)
