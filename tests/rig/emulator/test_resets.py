"""What resets the chip: watchdog and pin; resets of single peripherals are not modelled."""

import pytest

from rig.emulator.answers import BoardConfig
from rig.emulator.stops import StopKind
from tests.rig.emulator.programs import TICK, powered, word

LSI_HZ = 32_000
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
