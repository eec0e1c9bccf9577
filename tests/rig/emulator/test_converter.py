"""The analogue-to-digital converter: codes and their time; what it does not bear or is not modelled stops the run."""

import pytest

from rig.emulator.stops import StopKind
from tests.rig.emulator.programs import powered, word

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
