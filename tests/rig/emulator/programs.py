"""Small target programs for the tests of the emulated board: a prelude of register addresses, and their build."""

from pathlib import Path

from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import StopKind
from toolchain.host import CText
from toolchain.target import build_image

FOLDER = Path(__file__).resolve().parent
FLAGS = (
    "-O2",
    "-g",
    "-std=gnu11",
    "-ffreestanding",
    "-fno-sanitize=undefined",
    "-fno-stack-protector",
    "-Wall",
    "-Wno-unused-function",
    "-Werror",
)

PRELUDE = """
#include <stdint.h>
#define REG(address) (*(volatile uint32_t *)(address))
#define BARRIER() __asm volatile("dsb\\n isb" ::: "memory")
extern uint32_t _stack_top;
void Reset_Handler(void);
typedef void (*vector)(void);
#define VECTORS(...) \\
    __attribute__((section(".vectors"), used)) static const vector table[48] = {(vector)&_stack_top, Reset_Handler, __VA_ARGS__}
#define NAKED __attribute__((naked, noinline, used))
#define STOP() __asm volatile("bkpt 0")
static void clock_64_mhz(void) {
    REG(0x40022000) = 0x702;
    REG(0x4002100C) = 2u | 8u << 8 | 1u << 28 | 1u << 29;
    REG(0x40021000) |= 1u << 24;
    while (!(REG(0x40021000) & 1u << 25)) {}
    REG(0x40021008) = 2;
}
"""

# TIM6 interrupts every 10 ms, and the program counts.
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


def build(name: str, source: str) -> Path:
    """The ELF of one C text, with the prelude before it."""
    return build_image(f"test-{name}", [CText(f"{name}.c", PRELUDE + source)], FOLDER / "board.ld", flags=FLAGS)


def powered(name: str, source: str, config: BoardConfig | None = None) -> EmulatedBoard:
    """A board with that program, just powered up."""
    return EmulatedBoard(build(name, source), config)


def stopped(name: str, source: str, cycles: int = 200_000) -> EmulatedBoard:
    """A board on which that program has run to its STOP."""
    board = powered(name, source)
    stop = board.run_for(cycles)
    assert stop.kind == StopKind.BREAKPOINT, str(stop)
    return board


def word(board: EmulatedBoard, name: str, index: int = 0) -> int:
    """A 32-bit variable of the program, or an element of an array."""
    return int.from_bytes(board.read_memory(board.symbol(name)[0] + 4 * index, 4), "little")
