/* Virtual time: what is due when, and the conversion between cycles and picoseconds while the core clock may change. */
#ifndef SCHEDULE_H
#define SCHEDULE_H

#include "machine.h"

/* Do all that is due; false when the run ends. Otherwise `deadline` lies ahead of `now`. */
bool machine_service(machine *m);
void run_due_devices(machine *m);

/* Have `device` called at `cycle` (NEVER: not at all). */
void schedule(machine *m, enum device device, uint64_t cycle);
void schedule_ps(machine *m, enum device device, uint64_t time_ps);

uint64_t time_of_cycle_ps(const machine *m, uint64_t cycle);
uint64_t cycle_of_time(const machine *m, uint64_t time_ps);
static inline uint64_t now_ps(const machine *m) { return time_of_cycle_ps(m, m->core.now); }

#endif
