/* System instructions (DDI0419 B4) and the place where instructions meet everything else (`service`). */
#include "code.h"
#include "exceptions.h"
#include "fault.h"
#include "handler.h"
#include "schedule.h"
#include "special_registers.h"

#define SYSTEM_COST 3 /* MSR, MRS and the barriers, DDI0484C table 3-1 */

/* Do something to the saved state, then have it looked at right after this instruction. */
#define WITH_SAVED_STATE(action) \
    do {                         \
        SAVE_STATE();            \
        action;                  \
        attention(m);            \
        LOAD_STATE();            \
    } while (0)

HANDLER(service) {
    SAVE_STATE();
    if (!machine_service(m)) return;
    LOAD_STATE();
    JUMP ip->run(PASS);
}

HANDLER(op_cps) {
    WITH_SAVED_STATE(if (privileged(m)) m->core.primask = ip->imm);
    NEXT(1);
}

HANDLER(op_bkpt) {
    WITH_SAVED_STATE(fault(m, STOP_BREAKPOINT, pc_of(m, ip), ip->imm));
    JUMP service(PASS);
}

HANDLER(op_undefined) {
    WITH_SAVED_STATE(fault(m, STOP_UNDEFINED, pc_of(m, ip), ip->imm));
    JUMP service(PASS);
}

/* SVC that may not pre-empt becomes a HardFault (DDI0419 B1.5.4). */
HANDLER(op_svc) {
    if (m->core.priority[SV_CALL] >= execution_priority(m)) {
        WITH_SAVED_STATE(fault(m, STOP_SVC_ESCALATED, pc_of(m, ip), ip->imm));
        JUMP service(PASS);
    }
    WITH_SAVED_STATE(m->core.pending |= 1ull << SV_CALL);
    NEXT(1);
}

#define DEEP_SLEEP 4u /* SCR.SLEEPDEEP: the stop modes */

HANDLER(op_wfi) {
    if (m->core.scr & DEEP_SLEEP) {
        WITH_SAVED_STATE(fault(m, STOP_UNMODELLED, 0xE000ED10u, m->core.scr));
        JUMP service(PASS);
    }
    WITH_SAVED_STATE(m->core.sleeping = 1; m->core.waits_for_event = 0);
    NEXT(2);
}

HANDLER(op_wfe) {
    WITH_SAVED_STATE(m->core.sleeping = !m->core.event; m->core.waits_for_event = 1; m->core.event = 0);
    NEXT(2);
}

HANDLER(op_sev) {
    m->core.event = 1;
    NEXT(1);
}

HANDLER(op_msr) {
    WITH_SAVED_STATE(write_special(m, ip->imm, m->core.r[ip->n]));
    NEXT_BY(2, SYSTEM_COST);
}

HANDLER(op_mrs) {
    WITH_SAVED_STATE(m->core.r[ip->d] = read_special(m, ip->imm));
    NEXT_BY(2, SYSTEM_COST);
}

HANDLER(op_barrier) { NEXT_BY(2, SYSTEM_COST); }
