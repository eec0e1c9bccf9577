/* Faults and the end of a run. */
#ifndef FAULT_H
#define FAULT_H

#include "machine.h"

/* End the run with a record: what, where in the code, which address, and a number that explains it. */
void stop_run(machine *m, enum stop_kind kind, uint32_t address, uint32_t detail);

/* A fault at the instruction in `core.ip`: stops the run, or with `stop_on_fault` off takes HardFault or locks up. */
void fault(machine *m, enum stop_kind kind, uint32_t address, uint32_t detail);

/* Have everything but the next instruction looked at before it is executed. */
static inline void attention(machine *m) { m->deadline = m->core.now; }

#endif
