"""Exceptions by the rules of the architecture (DDI0419 B1.5): one small program for each rule."""

import pytest

from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.emulator.stops import StopKind
from tests.rig.emulator.probe import exception_counts
from tests.rig.emulator.programs import powered, word

TIM6, TIM7 = 17, 18
ENTRY_CYCLES, RETURN_CYCLES = 15, 15
COMMON = """
volatile uint32_t log_[32], logged;
static void note(uint32_t what) { log_[logged++] = what; }
static inline uint32_t ipsr(void) { uint32_t v; __asm volatile("mrs %0, ipsr" : "=r"(v)); return v; }
#define ISER REG(0xE000E100)
#define ISPR REG(0xE000E200)
#define IPR4 REG(0xE000E410) /* interrupts 16 to 19 */
#define ICSR REG(0xE000ED04)
#define SHPR2 REG(0xE000ED1C)
#define SHPR3 REG(0xE000ED20)
"""


def run(name: str, source: str, config: BoardConfig | None = None) -> EmulatedBoard:
    board = powered(name, COMMON + source, config)
    stop = board.run_for(100_000)
    assert stop.kind == StopKind.BREAKPOINT, str(stop)
    return board


def log(board: EmulatedBoard) -> list[int]:
    return [word(board, "log_", i) for i in range(word(board, "logged"))]


FRAME = """
volatile uint32_t frame[8], sp_in_handler, lr_in_handler, sp_before;
NAKED void svc(void) {
    __asm volatile("mov r0, sp\\n ldr r1, =sp_in_handler\\n str r0, [r1]\\n ldr r1, =lr_in_handler\\n mov r2, lr\\n str r2, [r1]\\n"
        "ldr r1, =frame\\n movs r2, #8\\n 1: ldmia r0!, {r3}\\n stmia r1!, {r3}\\n subs r2, #1\\n bne 1b\\n bx lr\\n .ltorg");
}
NAKED void Reset_Handler(void) {
    __asm volatile("sub sp, #PADDING\\n mov r0, sp\\n ldr r1, =sp_before\\n str r0, [r1]\\n"
        "ldr r0, =0x12121212\\n mov r12, r0\\n ldr r0, =0x14141414\\n mov lr, r0\\n"
        "movs r0, #10\\n movs r1, #11\\n movs r2, #12\\n movs r3, #13\\n"
        "cmp r0, r0\\n .global the_call\\n the_call: svc 7\\n bkpt 0\\n .ltorg");
}
VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, svc);
"""


@pytest.mark.parametrize("padding", [8, 4])
def test_an_exception_stacks_eight_words_aligned_to_eight_bytes_with_the_padding_told_in_bit_nine(padding: int) -> None:
    board = run(f"frame{padding}", FRAME.replace("PADDING", str(padding)))
    before, padded = 0x20008000 - padding, padding == 4
    frame = [word(board, "frame", i) for i in range(8)]
    return_address = board.symbol("the_call")[0] + 2
    z_and_c = 0x60000000
    assert frame == [
        10,
        11,
        12,
        13,
        0x12121212,
        0x14141414,
        return_address,
        z_and_c | 1 << 24 | (1 << 9 if padded else 0),
    ]
    assert word(board, "sp_before") == before
    assert word(board, "sp_in_handler") == before - 32 - (4 if padded else 0)
    assert word(board, "lr_in_handler") == 0xFFFFFFF9
    assert board.registers()[13] == before
    assert board.registers()[:4] == [10, 11, 12, 13]
    assert board.registers()[16] == z_and_c


RETURNS = """
NAKED void pendsv(void) { __asm volatile("mov r0, lr\\n b keep_lr"); }
NAKED void svc(void) {
    __asm volatile("push {lr}\\n mov r0, lr\\n bl keep_lr\\n"
        "ldr r0, =0xE000ED04\\n ldr r1, =0x10000000\\n str r1, [r0]\\n nop\\n pop {pc}\\n .ltorg");
}
__attribute__((used)) void keep_lr(uint32_t lr) { note(lr); }
uint64_t process_stack[32];
void Reset_Handler(void) {
    logged = 0;
    SHPR2 = 0x40000000; /* SVC 1, PendSV 0: it pre-empts */
    __asm volatile("svc 0");
    __asm volatile("msr psp, %0\\n movs r0, #2\\n msr control, r0\\n isb\\n svc 0"
        :: "r"(&process_stack[32]) : "r0", "r1", "r2", "r3", "lr", "memory");
    uint32_t control; __asm volatile("mrs %0, control" : "=r"(control));
    note(control);
    STOP();
}
VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, svc, 0, 0, pendsv);
"""


def test_exc_return_tells_mode_and_stack_of_the_interrupted_code() -> None:
    assert log(run("returns", RETURNS)) == [0xFFFFFFF9, 0xFFFFFFF1, 0xFFFFFFFD, 0xFFFFFFF1, 2]


NESTING = """
void low(void) { note(1); ISPR = 1u << 18; BARRIER(); note(2); }
void high(void) { note(100 + ipsr()); }
void Reset_Handler(void) {
    logged = 0;
    IPR4 = PRIORITIES;
    ISER = 3u << 17;
    ISPR = 1u << 17;
    BARRIER();
    note(9);
    STOP();
}
VECTORS([16 + 17] = low, [16 + 18] = high);
"""


@pytest.mark.parametrize(
    ("priorities", "order"),
    [("0x00008000", [1, 134, 2, 9]), ("0x00808000", [1, 2, 134, 9]), ("0x00C08000", [1, 2, 134, 9])],
    ids=["more urgent pre-empts", "equal waits", "less urgent waits"],
)
def test_only_a_more_urgent_interrupt_preempts(priorities: str, order: list[int]) -> None:
    source = NESTING.replace("PRIORITIES", priorities)
    assert log(run(f"nesting{priorities}", source)) == order


CHAIN = """
NAKED void empty(void) { __asm volatile("bx lr"); }
void Reset_Handler(void) {
    ISER = 3u << 17;
    __asm volatile("cpsid i");
    ISPR = PENDING;
    __asm volatile(".global before\\n before: cpsie i\\n .global after\\n after: nop");
    STOP();
}
VECTORS([16 + 17] = empty, [16 + 18] = empty);
"""


def _cycles_of(pending: str) -> int:
    board = powered(f"chain{pending[0]}", COMMON + CHAIN.replace("PENDING", pending))
    board.run_until_symbol("before", 1.0)
    start = board.cycles
    board.run_until_symbol("after", 1.0)
    return board.cycles - start


def test_a_tail_chained_interrupt_saves_the_sixteen_bus_cycles_of_unstacking_and_stacking() -> None:
    cps, bx = 1, 2
    one, two = _cycles_of("1u << 17"), _cycles_of("3u << 17")
    assert one == cps + ENTRY_CYCLES + bx + RETURN_CYCLES
    assert two - one == ENTRY_CYCLES + RETURN_CYCLES - 16 + bx


LATE = """
void low(void) { note(6); REG(0x40001010) = 0; }
NAKED void high(void) { __asm volatile("mov r0, lr\\n b served"); }
__attribute__((used)) void served(uint32_t lr) { note(lr); REG(0x40001410) = 0; }
void Reset_Handler(void) {
    logged = 0;
    IPR4 = 0x00008000; /* TIM6 less urgent than TIM7 */
    ISER = 3u << 17;
    REG(0x4002103C) = 3u << 4;
    REG(0x4000100C) = REG(0x4000140C) = 1;
    REG(0x4000102C) = 199;
    REG(0x4000142C) = 199;
    REG(0x40001424) = HEAD_START; /* TIM7 is started a few cycles after TIM6 */
    REG(0x40001000) = 1 | 8;
    REG(0x40001400) = 1 | 8;
    for (uint32_t i = 0; i < 200; i++) __asm volatile("nop");
    STOP();
}
VECTORS([16 + 17] = low, [16 + 18] = high);
"""
THREAD, NESTED = 0xFFFFFFF9, 0xFFFFFFF1


@pytest.mark.parametrize(
    ("head_start", "order"),
    [(100, [THREAD, 6]), (0, [THREAD, 6]), (-16, [NESTED, 6])],
    ids=["long before", "while the other's frame is pushed", "after the other has begun"],
)
def test_a_late_arrival_that_is_more_urgent_takes_over_the_frame(head_start: int, order: list[int]) -> None:
    source = LATE.replace("HEAD_START", str(max(head_start, 0)))
    if head_start < 0:
        source = source.replace("0x4000142C) = 199", f"0x4000142C) = {199 - head_start}")
    board = run(f"late{head_start}", source)
    assert log(board) == order
    assert exception_counts(board) == {16 + TIM6: 1, 16 + TIM7: 1}


MASKED = """
void irq(void) { note(1); }
void Reset_Handler(void) {
    logged = 0;
    ISER = 1u << 17;
    __asm volatile("cpsid i");
    ISPR = 1u << 17;
    BARRIER();
    note(2);
    __asm volatile("wfi"); /* wakes at once: the interrupt is pending, though masked */
    note(3);
    __asm volatile("cpsie i");
    note(4);
    STOP();
}
VECTORS([16 + 17] = irq);
"""


def test_primask_holds_an_interrupt_back_but_lets_it_wake_wfi() -> None:
    assert log(run("masked", MASKED)) == [2, 3, 1, 4]


PENDSV_LAST = """
void svc(void) { note(11); ICSR = 1u << 28; ICSR = 1u << 26; ISPR = 1u << 17; BARRIER(); note(12); }
void pendsv(void) { note(14); }
void systick(void) { note(15); }
void irq(void) { note(33); }
void Reset_Handler(void) {
    logged = 0;
    SHPR3 = 0x40C00000; /* SysTick 1, PendSV 3 */
    IPR4 = 0x00004000;
    ISER = 1u << 17;
    __asm volatile("svc 0");
    note(1);
    STOP();
}
VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, svc, 0, 0, pendsv, systick, [16 + 17] = irq);
"""


def test_pendsv_of_the_lowest_priority_comes_last_and_equals_are_taken_by_number() -> None:
    assert log(run("pendsv", PENDSV_LAST)) == [11, 12, 15, 33, 14, 1]


WAIT_FOR_EVENT = """
void Reset_Handler(void) {
    logged = 0;
    __asm volatile("sev\\n wfe"); /* the event is there already */
    note(1);
    REG(0xE000E010 + 4) = 999; REG(0xE000E018) = 0; REG(0xE000E010) = 7;
    __asm volatile("wfi");
    note(2);
    __asm volatile("yield\\n nop");
    STOP();
}
void systick(void) { note(15); }
VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, systick);
"""


def test_wfe_takes_a_registered_event_and_wfi_sleeps_to_the_system_timer() -> None:
    board = run("wfe", WAIT_FOR_EVENT)
    assert log(board) == [1, 15, 2]
    assert 1000 < board.cycles < 1000 + 150


SLEEP_ON_EXIT = """
void tick(void) { note(15); if (logged == 3) REG(0xE000ED10) = 0; }
void Reset_Handler(void) {
    logged = 0;
    REG(0xE000ED10) = 2; /* SLEEPONEXIT */
    REG(0xE000E014) = 999; REG(0xE000E018) = 0; REG(0xE000E010) = 7;
    __asm volatile("wfi");
    note(REG(0xE000ED04) >> 12 & 0x1FF);
    STOP();
}
VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, tick);
"""


def test_sleep_on_exit_returns_to_sleep_until_it_is_switched_off() -> None:
    assert log(run("sleep_on_exit", SLEEP_ON_EXIT)) == [15, 15, 15, 0]


PENDING_NUMBER = """
void Reset_Handler(void) {
    logged = 0;
    __asm volatile("cpsid i");
    IPR4 = 0x00004080;
    ISER = 7u << 16;
    ISPR = 7u << 16;
    note(ICSR >> 12 & 0x1FF);
    note(ICSR >> 22 & 1);
    STOP();
}
VECTORS(0);
"""


def test_the_pending_number_is_the_most_urgent_one_whatever_primask_says() -> None:
    assert log(run("pending_number", PENDING_NUMBER)) == [16 + 18, 1]


NMI = """
void nmi(void) { note(ipsr()); }
void Reset_Handler(void) {
    logged = 0;
    __asm volatile("cpsid i");
    ICSR = 1u << 31;
    BARRIER();
    note(1);
    STOP();
}
VECTORS(nmi);
"""


def test_nmi_ignores_primask() -> None:
    assert log(run("nmi", NMI)) == [2, 1]


HARD_FAULT = """
volatile uint32_t stacked_pc;
NAKED void fault(void) { __asm volatile("ldr r0, [sp, #24]\\n ldr r1, =stacked_pc\\n str r0, [r1]\\n HANDLER_END\\n .ltorg"); }
NAKED void Reset_Handler(void) { __asm volatile("PROLOGUE\\n .global culprit\\n culprit: CULPRIT\\n nop\\n 1: b 1b\\n .ltorg"); }
VECTORS(0, fault);
"""
FREE_RUNNING = BoardConfig(stop_on_fault=False)
SKIP_ONE = "ldr r0, [sp, #24]\\n adds r0, #2\\n str r0, [sp, #24]\\n bx lr"


@pytest.mark.parametrize(
    ("name", "prologue", "culprit"),
    [
        ("unmapped", "ldr r0, =0x60000000", "ldr r1, [r0]"),
        ("unaligned", "ldr r0, =0x20000001", "ldr r1, [r0]"),
        ("undefined", "nop", ".short 0xDE00"),
        ("svc_masked", "cpsid i", "svc 0"),
        ("breakpoint", "nop", "bkpt 0"),
    ],
)
def test_hard_fault_is_entered_at_the_faulting_instruction_when_the_run_shall_not_stop(
    name: str, prologue: str, culprit: str
) -> None:
    source = HARD_FAULT.replace("PROLOGUE", prologue).replace("CULPRIT", culprit).replace("HANDLER_END", SKIP_ONE)
    board = powered(f"fault_{name}", COMMON + source, FREE_RUNNING)
    board.run_until_symbol("fault", 1.0)
    assert board.registers()[16] & 0x3F == 3
    board.run_for(60)
    assert word(board, "stacked_pc") == board.symbol("culprit")[0]


def test_a_fault_inside_hard_fault_locks_up() -> None:
    source = (
        HARD_FAULT.replace("PROLOGUE", "cpsid i")
        .replace("CULPRIT", ".short 0xDE00")
        .replace("HANDLER_END", ".short 0xDE00")
    )
    stop = powered("lockup", COMMON + source, FREE_RUNNING).run_for(1000)
    assert stop.kind == StopKind.LOCKUP
    assert "lockup" in stop.message
    assert "fault" in stop.message


def test_an_illegal_exception_return_is_a_fault() -> None:
    source = """
    NAKED void svc(void) { __asm volatile("ldr r0, =0xFFFFFFF5\\n bx r0\\n .ltorg"); }
    void Reset_Handler(void) { __asm volatile("svc 0"); STOP(); }
    VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, svc);
    """
    stop = powered("bad_return", COMMON + source).run_for(1000)
    assert stop.kind == StopKind.BAD_RETURN
    assert "0xfffffff5" in stop.message


RESET_REQUEST = """
volatile uint32_t starts __attribute__((section(".bss.kept")));
void Reset_Handler(void) {
    uint32_t cause = REG(0x40021060);
    if (cause & 1u << 28) { note(cause); STOP(); }
    logged = 0;
    starts = 77;
    REG(0x40021060) = 1u << 23;
    note(REG(0x40021060) >> 24);
    REG(0xE000ED0C) = 0x05FA0004;
    for (;;) {}
}
VECTORS(0);
"""


def test_a_system_reset_request_restarts_the_core_keeps_ram_and_shows_its_cause() -> None:
    board = run("sysreset", RESET_REQUEST)
    software_and_pin = 1 << 28 | 1 << 26
    assert log(board) == [0, software_and_pin]
    assert word(board, "starts") == 77
    assert [reset.cause for reset in board.resets] == ["power", "software"]
