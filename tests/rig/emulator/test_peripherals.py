"""Clock tree, timers, encoders, PWM, pins, watchdog, identity."""

from itertools import pairwise

import pytest

from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import StopKind
from tests.rig.emulator.programs import powered, word

LSI_HZ = 32_000


def stopped(name: str, source: str, cycles: int = 200_000) -> EmulatedBoard:
    board = powered(name, source)
    stop = board.run_for(cycles)
    assert stop.kind == StopKind.BREAKPOINT, str(stop)
    return board


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


TICK = """
volatile uint32_t ticks;
void tick(void) { REG(0x40001010) = 0; ticks++; }
void Reset_Handler(void) {
    clock_64_mhz();
    REG(0x4002103C) = 3u << 4;
    REG(0x40001028) = 63;
    REG(0x4000102C) = 9999;
    REG(0x40001014) = 1;
    REG(0x40001010) = 0;
    REG(0x4000100C) = 1;
    REG(0x40001000) = 1;
    REG(0xE000E100) = 1u << 17;
    for (;;) __asm volatile("wfi");
}
VECTORS([16 + 17] = tick);
"""


def test_tim6_interrupts_every_ten_milliseconds_without_drift() -> None:
    board = powered("tick", TICK)
    board.run_until_s(1.0005)
    assert word(board, "ticks") == 100
    board.run_until_s(60.0005)
    assert word(board, "ticks") == 6000
    assert board.exception_counts() == {16 + 17: 6000}


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
    board.drive_pin("B", 1, True)
    board.run_for(1000)
    assert [word(board, "in", i) for i in range(3)] == [1 << 3 | 1 << 1, 1 << 1, 0x8008]
    assert board.gpio("B").drives(3) is True
    assert board.gpio("B").drives(4) is None


WATCHDOG = """
void Reset_Handler(void) {
    if (REG(0x40021060) & 1u << 29) STOP();
    REG(0x40003000) = 0xCCCC;
    REG(0x40003000) = 0x5555;
    REG(0x40003004) = 1; /* divide by 8 */
    REG(0x40003008) = 399; /* 400 counts: 100 ms */
    while (REG(0x4000300C)) {}
    for (uint32_t i = 0; i < FEEDS; i++) {
        REG(0x40003000) = 0xAAAA;
        for (uint32_t k = 0; k < 200000; k++) __asm volatile("nop");
    }
    REG(0x40003000) = 0xAAAA;
    for (;;) {}
}
VECTORS(0);
"""


@pytest.mark.parametrize("feeds", [0, 5])
def test_the_watchdog_bites_100_ms_after_the_last_feed_and_the_reset_names_it(feeds: int) -> None:
    board = powered(f"watchdog{feeds}", WATCHDOG.replace("FEEDS", str(feeds)))
    stop = board.run_until_s(2.0)
    assert stop.kind == StopKind.BREAKPOINT
    causes = [reset.cause for reset in board.resets]
    assert causes == ["power", "watchdog"]
    feeding_s = feeds * 200_000 * 4 / 16e6
    assert board.resets[1].time_s == pytest.approx(feeding_s + 400 * 8 / LSI_HZ, rel=0.01)


def test_a_shorter_watchdog_period_counts_from_the_next_feed_on() -> None:
    """Truth: RM0444 28.4.3. At 50 ms the period becomes 10 ms; the feed after it is in time, and the bite comes 10 ms later."""
    shorter = "REG(0x40003000) = 0x5555; REG(0x40003008) = 39; while (REG(0x4000300C)) {}"
    source = WATCHDOG.replace(
        "    REG(0x40003000) = 0xAAAA;\n    for (;;)", f"    {shorter}\n    REG(0x40003000) = 0xAAAA;\n    for (;;)"
    )
    assert shorter in source
    board = powered("watchdog_shorter", source.replace("FEEDS", "1"), BoardConfig(stop_on_reset=True))
    assert board.run_until_s(2.0).kind == StopKind.RESET
    assert board.time_s == pytest.approx(200_000 * 4 / 16e6 + 40 * 8 / LSI_HZ, rel=0.01)


def test_a_run_can_end_at_a_reset() -> None:
    board = powered("watchdog0", WATCHDOG.replace("FEEDS", "0"), BoardConfig(stop_on_reset=True))
    stop = board.run_until_s(2.0)
    assert stop.kind == StopKind.RESET
    assert board.time_s == pytest.approx(0.1, rel=0.01)


def test_the_pin_resets_without_touching_ram() -> None:
    board = powered("tick", TICK)
    board.run_until_s(0.1)
    ticks = word(board, "ticks")
    board.reset()
    assert [reset.cause for reset in board.resets] == ["power", "pin"]
    assert word(board, "ticks") == ticks > 0


@pytest.mark.parametrize("register", [0x40021024, 0x40021028, 0x4002102C, 0x40021030])
def test_resetting_single_peripherals_is_not_modelled_and_says_so_even_where_faults_do_not_stop(register: int) -> None:
    source = f"void Reset_Handler(void) {{ REG({register:#x}) = 0; REG({register:#x}) = 1; STOP(); }} VECTORS(0);"
    stop = powered(f"peripheral_reset_{register:x}", source, BoardConfig(stop_on_fault=False)).run_for(1000)
    assert stop.kind == StopKind.UNMODELLED
    assert f"{register:#010x}" in stop.message


def test_the_unique_id_is_the_configured_one() -> None:
    source = "volatile uint32_t id[3];\n"
    source += (
        "void Reset_Handler(void) { for (int i = 0; i < 3; i++) id[i] = REG(0x1FFF7590 + 4 * i); STOP(); } VECTORS(0);"
    )
    board = powered("identity", source, BoardConfig(unique_id=(1, 2, 3)))
    board.run_for(1000)
    assert [word(board, "id", i) for i in range(3)] == [1, 2, 3]


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


# Registers of the converter by RM0444 15.12: ISR, CR, CFGR2, SMPR, CHSELR, DR; its pins are analogue after a reset.
ADC = """
#define ISR REG(0x40012400)
#define CR REG(0x40012408)
#define CFGR2 REG(0x40012410)
#define SMPR REG(0x40012414)
#define CHSELR REG(0x40012428)
#define DR REG(0x40012440)
static void wait(int turns) { for (int i = 0; i < turns; i++) __asm volatile("nop"); }
static void start_converter(void) {
    clock_64_mhz();
    REG(0x40021040) = 1u << 20;
    REG(0x40021034) = 1;
    REG(0x50000000) = 0xFFFFFFFFu;
    CFGR2 = 2u << 30;
    CR = 1u << 28;
    wait(1300);
    CR = 1u << 31 | 1u << 28;
    while (CR >> 31) {}
    wait(16);
    CR = 1u << 28 | 1;
    while (!(ISR & 1)) {}
}
"""


def test_the_converter_takes_a_code_at_its_start_and_ends_after_sampling_and_conversion() -> None:
    """Truth: (12.5 + 39.5) clocks of 16 MHz, 208 of the core."""
    source = (
        ADC
        + """
    volatile uint32_t code, other, again, polls, ended;
    void Reset_Handler(void) {
        start_converter();
        SMPR = 5;
        CHSELR = 1u << 4;
        while (!(ISR & 1u << 13)) {}
        REG(0xE000E014) = 0xFFFFFF; REG(0xE000E018) = 0; REG(0xE000E010) = 5;
        uint32_t from = REG(0xE000E018);
        CR = 1u << 28 | 4;
        while (!(ISR & 4)) polls++;
        ended = from - REG(0xE000E018);
        code = DR;
        again = ISR & 4;
        CHSELR = 1u << 5;
        CR = 1u << 28 | 4;
        while (!(ISR & 4)) {}
        other = DR;
        STOP();
    }
    VECTORS(0);
    """
    )
    board = powered("adc", source)
    board.set_analogue(4, 1234)
    board.set_analogue(5, 99_999)
    stop = board.run_for(200_000)
    assert stop.kind == StopKind.BREAKPOINT, str(stop)
    assert (word(board, "code"), word(board, "other"), word(board, "again")) == (1234, 4095, 0)
    assert 208 <= word(board, "ended") <= 208 + 24  # one look at the flag
    assert word(board, "polls") > 5


WRONG_USES = {
    "a clock beyond 35 MHz": "clock_64_mhz(); REG(0x40021040) = 1u << 20; CFGR2 = 3u << 30; CR = 1u << 28; wait(1300); CR |= 1u << 31;",
    "switching off": "start_converter(); CR = 1u << 28 | 2;",
    "a regulator that has not settled": "REG(0x40021040) = 1u << 20; CFGR2 = 2u << 30; CR = 1u << 28; CR = 1u << 31 | 1u << 28;",
    "no calibration": "REG(0x40021040) = 1u << 20; CFGR2 = 2u << 30; CR = 1u << 28; wait(400); CR = 1u << 28 | 1;",
    "two channels": "start_converter(); CHSELR = 3u << 4; CR = 1u << 28 | 4;",
    "a pin that is not analogue": "start_converter(); REG(0x50000000) = 0; CHSELR = 1u << 4; CR = 1u << 28 | 4;",
    "an interrupt": "start_converter(); REG(0x40012404) = 4;",
    "eight bits": "start_converter(); REG(0x4001240C) = 2u << 3;",
}


@pytest.mark.parametrize("wrong", WRONG_USES)
def test_what_the_converter_does_not_bear_or_is_not_modelled_stops_the_run(wrong: str) -> None:
    source = ADC + f"void Reset_Handler(void) {{ {WRONG_USES[wrong]} STOP(); }} VECTORS(0);"
    assert powered(f"adc-{wrong.replace(' ', '-')}", source).run_for(200_000).kind == StopKind.UNMODELLED


def test_a_converter_without_its_clock_is_refused() -> None:
    board = powered("adc_off", "void Reset_Handler(void) { REG(0x40012408) = 1; STOP(); } VECTORS(0);")
    assert board.run_for(1000).kind == StopKind.UNCLOCKED
