"""Calling functions of the image, counting what they cost, and covering their lines."""

import numpy as np
import pytest

from codegen.numbers import float32_bits
from records.errors import BadInput
from rig.emulator.answers import StoppedError
from rig.emulator.bench import measure
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import StopKind
from tests.rig.emulator.probe import exception_counts
from tests.rig.emulator.programs import PRELUDE, build, powered, word

SOURCE = """
volatile uint32_t ticks;
void tick(void) { REG(0x40001010) = 0; ticks++; }
__attribute__((used, noinline)) int32_t divide(int32_t a, int32_t b) { return a / b; }
__attribute__((used, noinline)) float scale(float x) { return x * 1.5f + 0.25f; }
typedef struct { float x, y; } pair;
__attribute__((used, noinline)) uint32_t step(pair *state, const pair *in, pair *out) {
    state->x += in->x;
    out->x = state->x * in->y;
    out->y = in->x - in->y;
    return 7;
}
__attribute__((used, noinline)) uint32_t joined(uint32_t a, uint32_t b, uint32_t c, uint32_t d, uint32_t e, uint32_t f) {
    return ((((a * 10 + b) * 10 + c) * 10 + d) * 10 + e) * 10 + f;
}
__attribute__((used, noinline)) uint32_t deep(uint32_t n) {
    volatile uint32_t room[8];
    room[n & 7] = n;
    return n == 0 ? room[0] : deep(n - 1) + room[n & 7];
}
__attribute__((used, noinline)) void forever(void) { for (;;) {} }
__attribute__((used, noinline)) void stops_timer(void) { REG(0x40001000) = 0; }
__attribute__((used, noinline)) void resets(void) { REG(0xE000ED0C) = 0x05FA0004; for (;;) {} }
__attribute__((used, noinline)) void breaks(void) { STOP(); }
__attribute__((used, noinline)) uint32_t choose(uint32_t n) {
    if (n > 10)
        __asm volatile("nop");
    else
        __asm volatile("yield");
    return n;
}
void Reset_Handler(void) {
    ticks = 0;
    REG(0x4002103C) = 1u << 4;
    REG(0x4000102C) = 999;
    REG(0x4000100C) = 1;
    REG(0x40001000) = 1;
    REG(0xE000E100) = 1u << 17;
    for (;;) __asm volatile("wfi");
}
VECTORS([16 + 17] = tick);
"""


@pytest.fixture
def board() -> EmulatedBoard:
    return powered("calls", SOURCE)


def test_a_call_returns_what_the_function_returns(board: EmulatedBoard) -> None:
    assert board.call("divide", 1000, -7).result == (-142) & 0xFFFFFFFF
    assert board.call("scale", float32_bits(2.5)).result == float32_bits(4.0)


def test_a_call_leaves_core_peripherals_and_time_as_they_were(board: EmulatedBoard) -> None:
    board.run_for(12_345)
    before = (board.registers(), board.cycles, board.time_s, word(board, "ticks"))
    board.call("divide", 10**9, 3)
    board.call("stops_timer")
    assert (board.registers(), board.cycles, board.time_s, word(board, "ticks")) == before
    other = powered("calls", SOURCE)
    other.run_for(12_345)
    board.run_for(100_000)
    other.run_for(100_000)
    assert (board.registers(), board.cycles) == (other.registers(), other.cycles)
    assert word(board, "ticks") == 112


def test_the_cost_of_a_call_is_cycles_instructions_and_stack(board: EmulatedBoard) -> None:
    shallow, deep = board.call("deep", 0), board.call("deep", 10)
    assert deep.result == 55
    assert (deep.stack_bytes - shallow.stack_bytes) % 10 == 0
    assert deep.stack_bytes - shallow.stack_bytes >= 10 * 32
    assert deep.cycles > deep.instructions > shallow.instructions > 0
    assert deep.cycles_flash > deep.cycles


def test_many_calls_give_the_results_of_single_ones(board: EmulatedBoard) -> None:
    steps = 500
    rng = np.random.default_rng(5)
    inputs = rng.standard_normal((steps, 2)).astype(np.float32)
    base = board.scratch_address()
    state, inward, outward = base, base + 8, base + 16
    board.write_memory(state, bytes(8))
    batch = board.call_many("step", (state, inward, outward), [(inward, inputs)], [(outward, 8), (state, 8)], steps)
    x = np.float32(0)
    for k in range(steps):
        x = np.float32(x + inputs[k, 0])
        expected = np.array([np.float32(x * inputs[k, 1]), np.float32(inputs[k, 0] - inputs[k, 1])])
        assert batch.outputs[0][k].tobytes() == expected.tobytes()
        assert batch.outputs[1][k, :4].tobytes() == x.tobytes()
    assert set(batch.results) == {7}
    board.write_memory(state, bytes(8))
    board.write_memory(inward, inputs[0].tobytes())
    single = board.call("step", state, inward, outward)
    assert single.cycles == batch.cycles[0]
    assert batch.cycles_min <= single.cycles <= batch.cycles_max
    assert batch.stack_bytes >= single.stack_bytes > 0


def test_a_call_that_hangs_or_breaks_says_where(board: EmulatedBoard) -> None:
    with pytest.raises(StoppedError, match=r"in forever at calls\.c"):
        board.call("forever", max_cycles=1000)
    with pytest.raises(StoppedError, match=r"BKPT 0; pc .* in breaks") as caught:
        board.call_many("breaks", (), [], [], 3)
    assert caught.value.stop.kind == StopKind.BREAKPOINT
    with pytest.raises(StoppedError, match=r"was reset .* in resets"):
        board.call("resets")
    assert [reset.cause for reset in board.resets] == ["power"]
    assert board.call("divide", 9, 3).result == 3


def test_arguments_beyond_the_fourth_go_on_the_stack(board: EmulatedBoard) -> None:
    assert board.call("joined", 1, 2, 3, 4, 5, 6).result == 123456


def test_wrong_symbols_arguments_and_addresses_are_refused(board: EmulatedBoard) -> None:
    with pytest.raises(BadInput, match="no `absent`"):
        board.call("absent")
    with pytest.raises(BadInput, match="at most 8 words"):
        board.call("divide", *range(9))
    with pytest.raises(BadInput, match="at most 4 words"):
        board.call_many("divide", (1, 2, 3, 4, 5), [], [], 1)
    with pytest.raises(BadInput, match="range inside flash or SRAM"):
        board.read_memory(0x20007FFF, 2)
    with pytest.raises(BadInput, match="5 rows"):
        board.call_many("step", (), [(0x20000000, np.zeros((4, 2), np.float32))], [], 5)


def test_coverage_counts_executed_lines_and_shows_those_never_reached(board: EmulatedBoard) -> None:
    for _ in range(3):
        board.call("choose", 1)
    counts = board.coverage()["choose"]
    lines = {text.strip(): number for number, text in enumerate(_source_lines(), start=1)}
    assert counts["calls.c", lines["if (n > 10)"]] == 3
    assert counts["calls.c", lines['__asm volatile("yield");']] == 3
    assert counts["calls.c", lines['__asm volatile("nop");']] == 0
    board.call("choose", 11)
    assert board.coverage()["choose"]["calls.c", lines['__asm volatile("nop");']] == 1


def _source_lines() -> list[str]:
    return (PRELUDE + SOURCE).splitlines()


def test_the_same_input_gives_the_same_cycles_and_the_same_counters() -> None:
    def flown() -> tuple[object, ...]:
        board = EmulatedBoard(build("calls", SOURCE))
        board.run_until_s(0.05)
        board.call("deep", 20)
        board.run_until_s(0.1)
        return (
            board.cycles,
            board.instructions,
            board.registers(),
            exception_counts(board),
            board.execution_counts()[0].tobytes(),
        )

    assert flown() == flown()


def test_another_image_starts_the_board_afresh(board: EmulatedBoard) -> None:
    board.run_for(10_000)
    board.load(build("calls", SOURCE).read_bytes())
    assert (board.cycles, board.stack_bytes, word(board, "ticks")) == (0, 0, 0)
    assert board.call("divide", 6, 3).result == 2


def test_two_boards_live_side_by_side(board: EmulatedBoard) -> None:
    other = powered("calls", SOURCE)
    board.run_for(10_000)
    assert other.cycles == 0
    assert board.cycles >= 10_000


def test_a_host_break_stops_before_the_instruction_and_lets_it_run_after(board: EmulatedBoard) -> None:
    for expected in (0, 1, 2):
        stop = board.run_until_symbol("tick", 1.0)
        assert (stop.kind, stop.pc) == (StopKind.HOST_BREAK, board.symbol("tick")[0])
        assert word(board, "ticks") == expected


def test_the_high_water_mark_of_the_stack_counts_exception_frames(board: EmulatedBoard) -> None:
    board.run_for(500)
    before = board.stack_bytes
    board.run_for(10_000)
    assert board.stack_bytes >= before + 32


def test_the_speed_is_instructions_of_real_work_per_cpu_second(board: EmulatedBoard) -> None:
    steps = 2000
    speed = measure(board, "scale", (float32_bits(2.5),), steps)
    single = board.call("scale", float32_bits(2.5))
    assert (speed.instructions, speed.cycles) == (steps * single.instructions, steps * single.cycles)
    assert speed.instructions_per_s == speed.instructions / speed.cpu_s > 0
