"""Each fault stops the run with its kind, and a line that names pc, function and source line."""

import re

import pytest

from rig.emulator.stops import FAULTS, SENTENCES, StopKind
from tests.rig.emulator.programs import PRELUDE, powered

CULPRITS = {
    StopKind.UNMAPPED: ("REG(0x60000000) = 1;", "0x60000000, where nothing is mapped"),
    StopKind.UNALIGNED: ("REG(0x20000002) = 1;", "4 bytes to 0x20000002"),
    StopKind.UNDEFINED: ('__asm volatile(".short 0xDE01");', "undefined instruction 0xde01"),
    StopKind.STACK_LIMIT: (
        '__asm volatile("ldr r0, =0x20007010\\n mov sp, r0\\n push {r0-r7}");',
        "stack reached 0x20006ff0",
    ),
    StopKind.BREAKPOINT: ('__asm volatile("bkpt 42");', "BKPT 42"),
    StopKind.SVC_ESCALATED: ('__asm volatile("cpsid i\\n svc 3");', "SVC 3"),
    StopKind.UNCLOCKED: ("REG(0x40004400) = 1;", "0x40004400, a peripheral whose clock is off"),
    StopKind.UNMODELLED: ("REG(0x40022014) = 1;", "register 0x40022014"),
    StopKind.FLASH_WRITE: ("REG(0x08000100) = 5;", "write of 0x5 to flash at 0x08000100"),
}


@pytest.mark.parametrize("kind", CULPRITS, ids=lambda kind: kind.name)
def test_a_fault_stops_the_run_and_names_function_and_line(kind: StopKind) -> None:
    statement, sentence = CULPRITS[kind]
    culprit = f"__attribute__((noinline)) static void culprit(void) {{\n    {statement}\n}}\n"
    source = culprit + "void Reset_Handler(void) { culprit(); for (;;) {} }\nVECTORS(0);"
    board = powered(f"culprit_{kind.name}", source)
    stop = board.run_for(10_000)
    line = PRELUDE.count("\n") + 2
    assert stop.kind == kind
    assert stop.is_fault
    assert sentence in stop.message
    assert re.search(
        rf"; pc 0x0800[0-9a-f]{{4}} in (culprit|Reset_Handler) at culprit_{kind.name}.c:{line}$", stop.message
    ), stop.message


def test_execution_outside_code_names_the_place() -> None:
    board = powered("wild", "void Reset_Handler(void) { ((void (*)(void))0x30000001)(); } VECTORS(0);")
    stop = board.run_for(1000)
    assert (stop.kind, stop.pc, stop.address) == (StopKind.UNMAPPED, 0x30000000, 0x30000000)


def test_a_branch_to_arm_code_is_refused() -> None:
    board = powered("arm", "void Reset_Handler(void) { ((void (*)(void))0x08000100)(); } VECTORS(0);")
    stop = board.run_for(1000)
    assert (stop.kind, stop.address) == (StopKind.NOT_THUMB, 0x08000100)


def test_every_kind_has_its_sentence_and_the_same_fault_is_met_again() -> None:
    assert set(SENTENCES) == set(StopKind)
    assert min(FAULTS) == StopKind.UNMAPPED
    board = powered("again", "void Reset_Handler(void) { STOP(); } VECTORS(0);")
    first, cycles = board.run_for(100), board.cycles
    assert board.run_for(100) == first
    assert board.cycles == cycles


def test_an_exception_frame_below_the_stack_limit_is_found() -> None:
    source = """
    void svc(void) {}
    NAKED void Reset_Handler(void) { __asm volatile("ldr r0, =0x20007010\\n mov sp, r0\\n svc 0\\n .ltorg"); }
    VECTORS(0, 0, 0, 0, 0, 0, 0, 0, 0, svc);
    """
    stop = powered("frame_limit", source).run_for(100)
    assert (stop.kind, stop.address) == (StopKind.STACK_LIMIT, 0x20006FF0)
