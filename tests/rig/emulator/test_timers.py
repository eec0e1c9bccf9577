"""Timers: the basic ones and their flags, the core's system timer, encoders, PWM."""

from itertools import pairwise

import pytest

from tests.rig.emulator.probe import exception_counts
from tests.rig.emulator.programs import TICK, powered, stopped, word


def test_tim6_interrupts_every_ten_milliseconds_without_drift() -> None:
    board = powered("tick", TICK)
    board.run_until_s(1.0005)
    assert word(board, "ticks") == 100
    board.run_until_s(60.0005)
    assert word(board, "ticks") == 6000
    assert exception_counts(board) == {16 + 17: 6000}


@pytest.mark.parametrize(("name", "prescaler", "reload"), [("one", 0, 199), ("three", 2, 99), ("many", 999, 1)])
def test_a_period_is_the_product_of_prescaler_and_reload_each_plus_one(name: str, prescaler: int, reload: int) -> None:
    source = TICK.replace("1028) = 63", f"1028) = {prescaler}").replace("102C) = 9999", f"102C) = {reload}")
    board = powered(f"period_{name}", source)
    board.run_until_s(0.5)
    assert word(board, "ticks") == pytest.approx(32e6 / ((prescaler + 1) * (reload + 1)), abs=2)


SYSTEM_TICK = """
volatile uint32_t ticks;
void tick(void) { ticks++; }
void Reset_Handler(void) {
    ticks = 0;
    REG(0xE000E014) = RELOAD; REG(0xE000E018) = 0; REG(0xE000E010) = CONTROL;
    for (;;) __asm volatile("wfi");
}
VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, tick);
"""


@pytest.mark.parametrize(("reload", "control", "ticks"), [(15_999, 7, 1000), (159, 7, 100_000), (1_999, 3, 1000)])
def test_the_system_timer_interrupts_every_reload_plus_one_counts_of_the_core_or_an_eighth_of_it(
    reload: int, control: int, ticks: int
) -> None:
    board = powered(f"system_tick{reload}", SYSTEM_TICK.replace("RELOAD", str(reload)).replace("CONTROL", str(control)))
    board.run_until_s(1.0)
    assert word(board, "ticks") == pytest.approx(ticks, abs=1)


def test_the_system_timer_wakes_the_core_at_exact_cycles() -> None:
    board = powered("system_tick159", SYSTEM_TICK.replace("RELOAD", "159").replace("CONTROL", "7"))
    woken = []
    for _ in range(5):
        board.run_until_symbol("tick", 1.0)
        woken.append(board.cycles)
    assert [after - before for before, after in pairwise(woken)] == [160] * 4


BUFFERED = """
volatile uint32_t counts[6];
void Reset_Handler(void) {
    REG(0x4002103C) = 3u << 4;
    REG(0x4000142C) = 99;
    REG(0x40001400) = 1 | OPTIONS;
    for (int i = 0; i < 100; i++) __asm volatile("nop");
    counts[0] = REG(0x40001410);
    REG(0x40001410) = 0;
    counts[1] = REG(0x40001410);
    REG(0x40001414) = 1;
    counts[2] = REG(0x40001410);
    counts[3] = REG(0x40001400);
    REG(0x40001424) = 77;
    counts[4] = REG(0x40001424);
    STOP();
}
VECTORS(0);
"""


@pytest.mark.parametrize(
    ("options", "flags", "after_generation", "running"),
    [("0", 1, 1, True), ("4", 1, 0, True), ("2", 0, 0, True), ("8", 1, 1, False)],
    ids=["plain", "URS: software update sets no flag", "UDIS: no update", "one pulse stops at the update"],
)
def test_update_flag_and_one_pulse_mode_follow_the_control_bits(
    options: str, flags: int, after_generation: int, running: bool
) -> None:
    board = stopped(f"buffered{options}", BUFFERED.replace("OPTIONS", options))
    seen = [word(board, "counts", i) for i in range(5)]
    assert seen[:3] == [flags, 0, after_generation]
    assert bool(seen[3] & 1) == running
    assert 77 <= seen[4] <= 77 + (8 if running else 0)


ENCODERS = """
volatile uint32_t go, low, high, direction;
void Reset_Handler(void) {
    REG(0x4002103C) = 3;
    REG(0x40000008) = 3;
    REG(0x40000408) = 3;
    REG(0x4000042C) = 4095;
    REG(0x40000000) = REG(0x40000400) = 1;
    for (;;) { low = REG(0x40000424); high = REG(0x40000024); direction = REG(0x40000400) >> 4 & 1; }
}
VECTORS(0);
"""


@pytest.mark.parametrize(
    ("counts", "tim2", "tim3"),
    [(5, 5, 5), (-1, 0xFFFFFFFF, 4095), (4096, 4096, 0), (-5000, 2**32 - 5000, 3192), (70_000, 70_000, 368)],
)
def test_encoder_counters_wrap_at_their_reload_plus_one(counts: int, tim2: int, tim3: int) -> None:
    board = powered("encoders", ENCODERS)
    board.run_for(500)
    board.set_encoder(2, counts)
    board.set_encoder(3, counts)
    board.run_for(500)
    assert (word(board, "high"), word(board, "low")) == (tim2, tim3)
    assert word(board, "direction") == (1 if counts < 0 else 0)


def test_pwm_reports_compare_values_period_and_the_main_output_enable() -> None:
    source = """
    void Reset_Handler(void) {
        REG(0x40021040) = 1u << 11;
        REG(0x40012C2C) = 3199; REG(0x40012C34) = 800; REG(0x40012C38) = 1600; REG(0x40012C20) = 0x11;
        REG(0x40012C00) = 1;
        BDTR
        STOP();
    }
    VECTORS(0);
    """
    off = stopped("pwm_off", source.replace("BDTR", "")).pwm()
    assert (off.main_ticks, off.tail_ticks, off.period_ticks, off.enabled, off.channels_enabled) == (
        800,
        1600,
        3200,
        False,
        (True, True),
    )
    assert stopped("pwm_on", source.replace("BDTR", "REG(0x40012C44) = 1u << 15;")).pwm().enabled


def test_system_timer_counts_down_through_zero_and_reloads() -> None:
    source = """
    volatile uint32_t values[4];
    void Reset_Handler(void) {
        REG(0xE000E014) = 9; REG(0xE000E018) = 0; REG(0xE000E010) = 5;
        values[0] = REG(0xE000E010) >> 16 & 1;
        for (int i = 0; i < 50; i++) __asm volatile("nop");
        values[1] = REG(0xE000E010) >> 16 & 1;
        values[2] = REG(0xE000E018);
        REG(0xE000E010) = 0;
        STOP();
    }
    VECTORS(0);
    """
    board = stopped("systick", source)
    assert [word(board, "values", i) for i in range(2)] == [0, 1]
    assert word(board, "values", 2) <= 9
