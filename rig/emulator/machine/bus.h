/* The bus: flash, SRAM, system control space and peripherals by address (RM0444 2.2). */
#ifndef BUS_H
#define BUS_H

#include "machine.h"

/* An access of 1, 2 or 4 bytes by the core. On false the fault is already recorded or pending. */
bool bus_read(machine *m, uint32_t address, uint32_t size, uint32_t *value);
bool bus_write(machine *m, uint32_t address, uint32_t size, uint32_t value);

/* Host access to flash, its alias and SRAM without side effects; NULL when the range is not memory. */
uint8_t *bus_memory(machine *m, uint32_t address, uint32_t size);

#endif
