/* Every change of a stack pointer passes here: the high-water mark, and the limit of the main stack. */
#ifndef STACK_GUARD_H
#define STACK_GUARD_H

#include "machine.h"

static inline enum stack stack_in_use(const machine *m) { return m->core.control & 2u && !m->core.ipsr ? PROCESS_STACK : MAIN_STACK; }

/* Note that `stack` now reaches down to `sp`; false when that is below its limit. */
static inline bool stack_reaches(machine *m, enum stack stack, uint32_t sp) {
    if (sp < m->count.lowest_sp[stack]) m->count.lowest_sp[stack] = sp;
    return stack == PROCESS_STACK || sp >= m->stack_limit || !m->stop_on_fault;
}

#endif
