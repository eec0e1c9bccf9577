/* Resets of core and peripherals; RAM keeps its content. */
#ifndef RESET_H
#define RESET_H

#include "machine.h"

void machine_reset(machine *m, uint32_t cause);

#endif
