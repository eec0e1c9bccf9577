/* Exceptions of ARMv6-M (DDI0419 B1.5): priorities, entry, return, tail-chaining, late arrival. */
#ifndef EXCEPTIONS_H
#define EXCEPTIONS_H

#include "machine.h"

#define HARD_FAULT_PRIORITY (-1)

/* Priority of what is being executed: 256 is thread mode with everything allowed; lower numbers are more urgent. */
int32_t execution_priority(const machine *m);

/* The pending and enabled exception that would be taken now, 0 for none. */
uint32_t exception_next(const machine *m);

/* The most urgent of those pending and enabled, whether it may be taken now or not (VECTPENDING). */
uint32_t exception_waiting(const machine *m);

/* The same as if PRIMASK were clear: what wakes WFI. */
bool exception_wakes(const machine *m);

void exception_enter(machine *m);
void exception_return(machine *m, uint32_t exc_return);

/* A peripheral's interrupt request line. */
void interrupt_line(machine *m, uint32_t irq, bool level);

/* Make an exception pending, as a pulse or by software. */
void exception_pend(machine *m, uint32_t number);

#endif
