#include "special_registers.h"

#include "fault.h"
#include "stack_guard.h"

enum { LAST_PSR = 7, MSP = 8, PSP = 9, PRIMASK = 16, CONTROL = 20 };

uint32_t flags_of(const machine *m) {
    uint32_t n = m->core.n & 0x80000000u, z = m->core.z == 0, v = m->core.v >> 31;
    return n | z << 30 | m->core.c << 29 | v << 28;
}

void set_flags(machine *m, uint32_t xpsr) {
    m->core.n = xpsr;
    m->core.z = ~xpsr & 0x40000000u;
    m->core.c = xpsr >> 29 & 1u;
    m->core.v = xpsr << 3;
}

void set_mode(machine *m, uint32_t ipsr, uint32_t control) {
    enum stack before = stack_in_use(m);
    m->core.ipsr = ipsr;
    m->core.control = control;
    if (stack_in_use(m) == before) return;
    uint32_t sp = m->core.r[13];
    m->core.r[13] = m->core.other_sp;
    m->core.other_sp = sp;
}

static uint32_t *stack_pointer(machine *m, enum stack stack) {
    return stack_in_use(m) == stack ? &m->core.r[13] : &m->core.other_sp;
}

uint32_t read_special(const machine *m, uint32_t number) {
    if (number <= LAST_PSR) return (number & 4u ? 0 : flags_of(m)) | (number & 1u ? m->core.ipsr : 0);
    if (!privileged(m) && number != CONTROL) return 0;
    enum stack in_use = stack_in_use(m);
    switch (number) {
    case MSP: return in_use == MAIN_STACK ? m->core.r[13] : m->core.other_sp;
    case PSP: return in_use == PROCESS_STACK ? m->core.r[13] : m->core.other_sp;
    case PRIMASK: return m->core.primask;
    default: return m->core.control;
    }
}

static void write_stack_pointer(machine *m, enum stack stack, uint32_t value) {
    uint32_t sp = value & ~3u;
    if (!stack_reaches(m, stack, sp)) fault(m, STOP_STACK_LIMIT, sp, 0);
    *stack_pointer(m, stack) = sp;
}

void write_special(machine *m, uint32_t number, uint32_t value) {
    if (number <= 3) set_flags(m, value);
    if (!privileged(m)) return;
    if (number == MSP) write_stack_pointer(m, MAIN_STACK, value);
    if (number == PSP) write_stack_pointer(m, PROCESS_STACK, value);
    if (number == PRIMASK) m->core.primask = value & 1u;
    if (number == CONTROL) set_mode(m, m->core.ipsr, m->core.ipsr ? (value & 1u) | (m->core.control & 2u) : value & 3u);
}
