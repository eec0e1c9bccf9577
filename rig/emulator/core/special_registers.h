/* xPSR, MSP, PSP, PRIMASK, CONTROL (DDI0419 B1.4). */
#ifndef SPECIAL_REGISTERS_H
#define SPECIAL_REGISTERS_H

#include "machine.h"

static inline bool privileged(const machine *m) { return m->core.ipsr != 0 || !(m->core.control & 1u); }

/* `number` is SYSm of MSR and MRS. */
uint32_t read_special(const machine *m, uint32_t number);
void write_special(machine *m, uint32_t number, uint32_t value);

uint32_t flags_of(const machine *m);
void set_flags(machine *m, uint32_t xpsr);

/* Change CONTROL or the mode, and with them which stack pointer is in use. */
void set_mode(machine *m, uint32_t ipsr, uint32_t control);

#endif
