"""Target programs whose time and stack are known by hand, in one image."""

from functools import cache
from pathlib import Path

from tests.rig.emulator.programs import build

# One instruction each, and the cycles that DDI0484C table 3-1 gives it; PUSH with lr and POP with pc as the slower sources say.
INSTRUCTIONS = {
    "movs r0, #1": 1, "movs r0, r1": 1, "mov r0, r8": 1, "mov r8, r0": 1, "adds r0, r1, r2": 1, "adds r0, #3": 1,
    "subs r0, r1, #1": 1, "add r0, r8": 1, "add r0, sp, #4": 1, ".inst.n 0xA001": 1, "cmp r0, #1": 1,
    "cmp r0, r8": 1, "cmn r0, r1": 1, "ands r0, r1": 1, "eors r0, r1": 1, "orrs r0, r1": 1, "bics r0, r1": 1,
    "mvns r0, r1": 1, "tst r0, r1": 1, "muls r0, r1": 1, "lsls r0, r1, #2": 1, "lsrs r0, r1, #32": 1,
    "asrs r0, r1, #3": 1, "lsls r0, r1": 1, "lsrs r0, r1": 1, "asrs r0, r1": 1, "rors r0, r1": 1, "adcs r0, r1": 1,
    "sbcs r0, r1": 1, "rsbs r0, r1, #0": 1, "sxtb r0, r1": 1, "sxth r0, r1": 1, "uxtb r0, r1": 1, "uxth r0, r1": 1,
    "rev r0, r1": 1, "rev16 r0, r1": 1, "revsh r0, r1": 1, "nop": 1, "cpsie i": 1,
    "sub sp, #8\n ldr r0, [sp, #4]\n str r0, [sp]\n add sp, #8": 6, "ldr r0, [r3]": 2, "ldrh r0, [r3, #2]": 2,
    "ldrb r0, [r3, #1]": 2, "ldr r0, [r3, r2]": 2, "ldrsh r0, [r3, r2]": 2, "ldrsb r0, [r3, r2]": 2,
    "str r0, [r3]": 2, "strh r0, [r3, #2]": 2, "strb r0, [r3, #1]": 2, "strh r0, [r3, r2]": 2,
    "strb r0, [r3, r2]": 2, "ldm r3!, {r0, r1}": 3, "stm r3!, {r0, r1, r2}": 4, "push {r0}\n add sp, #4": 3,
    "push {r4, lr}\n add sp, #8": 4, "push {r0, r1}\n pop {r0, r1}": 6, "sub sp, #8\n add sp, #8": 2,
    "mrs r0, apsr": 3, "msr apsr_nzcvq, r0": 3, "dmb": 3, "dsb": 3, "isb": 3, "b 1f\n nop\n 1:": 2,
    "cmp r0, r0\n beq 1f\n nop\n 1:": 3, "cmp r0, r0\n bne 1f\n 1:": 2,
    "push {lr}\n bl empty\n pop {pc}": 2 + 3 + 2 + 4, "push {r4, lr}\n pop {r4, pc}": 3 + 5,
}  # fmt: skip
RETURN_CYCLES = 2  # bx lr behind each of them, but for those that return by POP

PROGRAMS = r"""
#define KEPT __attribute__((used, retain, noinline))
KEPT NAKED void empty(void) { __asm volatile("bx lr"); }

/* Both ways of a branch: 1 + (1 + 3 or 2 + 1) + 2. */
KEPT NAKED int branching(int x) { __asm volatile("cmp r0, #5\n bne 1f\n dsb\n 1: nop\n bx lr"); }

/* Two tests of one unchanged number: no input takes both long ways. */
KEPT NAKED int excluding(unsigned x) {
    __asm volatile("cmp r0, #5\n bhs 1f\n dsb\n dsb\n 1: cmp r0, #5\n blo 2f\n dsb\n dsb\n 2: bx lr");
}

/* 1 + 10 * (1 + 1) + 9 * 2 + 1 + 2. */
KEPT NAKED void ten_passes(void) { __asm volatile("movs r1, #10\n 1: nop\n subs r1, #1\n bne 1b\n bx lr"); }
KEPT NAKED void nested_loops(void) {
    __asm volatile("movs r1, #5\n 1: movs r2, #7\n 2: subs r2, #1\n bne 2b\n subs r1, #1\n bne 1b\n bx lr");
}
KEPT NAKED void passes_by_argument(unsigned n) { __asm volatile("1: subs r0, #1\n bne 1b\n bx lr"); }
KEPT NAKED void at_most_eight_passes(unsigned n) {
    __asm volatile("movs r1, #7\n ands r0, r1\n adds r0, #1\n 1: subs r0, #1\n bne 1b\n bx lr");
}

KEPT NAKED int inner(void) { __asm volatile("push {r4, r5, r6, lr}\n sub sp, #24\n add sp, #24\n pop {r4, r5, r6, pc}"); }
KEPT NAKED int middle(void) { __asm volatile("push {lr}\n sub sp, #4\n bl inner\n add sp, #4\n pop {pc}"); }
KEPT NAKED int outer(void) { __asm volatile("push {r4, lr}\n bl empty\n bl middle\n sub sp, #100\n add sp, #100\n pop {r4, pc}"); }
KEPT NAKED int leaving(void) { __asm volatile("push {r4, lr}\n pop {r4}\n pop {r1}\n mov lr, r1\n b inner"); }

KEPT NAKED int calling_itself(int n) { __asm volatile("push {lr}\n bl by_another\n pop {pc}"); }
KEPT NAKED int by_another(int n) { __asm volatile("push {lr}\n bl calling_itself\n pop {pc}"); }
KEPT NAKED void by_pointer(void (*f)(void)) { __asm volatile("push {lr}\n blx r0\n pop {pc}"); }
KEPT NAKED void by_known_pointer(void) { __asm volatile("push {lr}\n ldr r0, =empty\n blx r0\n pop {pc}\n .ltorg"); }
KEPT NAKED void sleeping(void) { __asm volatile("wfi\n bx lr"); }
KEPT NAKED void into_data(void) { __asm volatile("nop\n .word 0\n"); }
KEPT NAKED int of_any_size(int n) { __asm volatile("mov r3, sp\n subs r3, r3, r0\n mov sp, r3\n bx lr"); }

KEPT int chosen(int x, int y) {
    switch (x) {
    case 0: return y * 3;
    case 1: return y + 7;
    case 2: return y ^ 5;
    case 3: return y - 9;
    case 4: return y << 3;
    case 5: return y * y;
    case 6: return ~y;
    }
    return 0;
}
KEPT unsigned large_frame(unsigned a) {
    volatile unsigned v[300];
    for (unsigned i = 0; i < 300; i++) v[i] = a + i;
    return v[a & 15u];
}
KEPT unsigned byte_quotient(unsigned a, unsigned b) { return (a & 0xffu) / (b & 0xffu); }
KEPT unsigned quotient(unsigned a, unsigned b) { return a / b; }
KEPT float sum(float a, float b) { return a + b; }
KEPT float product(float a, float b) { return a * b; }
KEPT float ratio(float a, float b) { return a / b; }
KEPT int less(float a, float b) { return a < b; }
KEPT int whole(float a) { return (int)a; }
KEPT float as_float(int a) { return (float)a; }
KEPT void Reset_Handler(void) { for (;;) {} }
VECTORS(0);
"""


def instruction_name(index: int) -> str:
    """Function that holds the `index`-th instruction."""
    return f"instruction_{index}"


@cache
def program() -> Path:
    """The ELF of all programs."""
    single = [
        f'KEPT NAKED void {instruction_name(index)}(void) {{ __asm volatile("{text}\\n bx lr"); }}'.replace(
            "\n ", "\\n "
        )
        for index, text in enumerate(INSTRUCTIONS)
    ]
    return build("static-bound", PROGRAMS + "\n".join(single))
