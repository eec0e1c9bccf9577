/* Resets of core and peripherals; RAM keeps its content. */
#ifndef RESET_H
#define RESET_H

#include "machine.h"

void machine_reset(machine *m, uint32_t cause);

/* As the boot loader in system memory hands the chip over to the program whose vectors stand at this place in flash. */
void boot_loader_leaves(machine *m, uint32_t flash_offset);

#endif
