#include "fault.h"

#include "code.h"
#include "exceptions.h"

void stop_run(machine *m, enum stop_kind kind, uint32_t address, uint32_t detail) {
    if (m->stop.kind == STOP_NONE) m->stop = (stop_record){kind, pc_of(m, m->core.ip), address, detail};
    attention(m);
}

void fault(machine *m, enum stop_kind kind, uint32_t address, uint32_t detail) {
    bool beyond_the_model = kind == STOP_UNMODELLED || kind == STOP_FLASH_LATENCY;
    if (m->stop_on_fault || m->in_call || beyond_the_model)
        stop_run(m, kind, address, detail);
    else if (execution_priority(m) <= HARD_FAULT_PRIORITY)
        stop_run(m, STOP_LOCKUP, address, kind); /* DDI0419 B1.5.15: a fault that HardFault cannot pre-empt */
    else
        m->core.pending |= 1ull << HARD_FAULT;
    attention(m);
}
