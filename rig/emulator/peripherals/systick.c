/* SysTick (DDI0419 B3.3): a 24-bit down-counter, clocked by the core or by core / 8. */
#include "exceptions.h"
#include "peripherals.h"
#include "schedule.h"

enum { CSR = 0x0, RVR = 0x4, CVR = 0x8 };
enum { ENABLE = 1, TICKINT = 2, CLKSOURCE = 4, COUNTFLAG = 1 << 16 };
#define MAX_COUNT 0xFFFFFFu

static uint32_t cycles_per_count(const systick_state *s) { return s->csr & CLKSOURCE ? 1 : 8; }

/* Counts from reload to zero and again: a period is RVR + 1; a count of zero reloads at the next clock. */
static uint32_t value_now(machine *m) {
    systick_state *s = &m->device.systick;
    uint64_t counts = (m->core.now - s->base_cycle) / cycles_per_count(s);
    if (!(s->csr & ENABLE) || s->rvr == 0) return s->base_value;
    if (counts <= s->base_value) return s->base_value - (uint32_t)counts;
    return s->rvr - (uint32_t)((counts - s->base_value - 1) % (s->rvr + 1ull));
}

static void restart(machine *m, uint32_t value) {
    systick_state *s = &m->device.systick;
    s->base_value = value;
    s->base_cycle = m->core.now;
    bool counts = s->csr & ENABLE && s->rvr != 0;
    uint64_t to_zero = value ? value : s->rvr + 1ull;
    schedule(m, DEV_SYSTICK, counts ? m->core.now + to_zero * cycles_per_count(s) : NEVER);
}

void systick_event(machine *m) {
    systick_state *s = &m->device.systick;
    s->csr |= COUNTFLAG;
    if (s->csr & TICKINT) exception_pend(m, SYS_TICK);
    /* An event is served after the instruction during which it fell due; no count is lost by that. */
    uint64_t period = (s->rvr + 1ull) * cycles_per_count(s);
    uint64_t zero_cycle = s->base_cycle + (s->base_value ? s->base_value : s->rvr + 1ull) * cycles_per_count(s);
    s->base_cycle = zero_cycle;
    s->base_value = 0;
    schedule(m, DEV_SYSTICK, zero_cycle + period);
}

bool systick_read(machine *m, uint32_t offset, uint32_t *value) {
    systick_state *s = &m->device.systick;
    switch (offset) {
    case CSR:
        *value = s->csr;
        s->csr &= ~(uint32_t)COUNTFLAG;
        return true;
    case RVR: *value = s->rvr; return true;
    case CVR: *value = value_now(m); return true;
    default: return false;
    }
}

bool systick_write(machine *m, uint32_t offset, uint32_t value) {
    systick_state *s = &m->device.systick;
    uint32_t count = value_now(m);
    switch (offset) {
    case CSR: s->csr = (value & 7u) | (s->csr & COUNTFLAG); break;
    case RVR: s->rvr = value & MAX_COUNT; break;
    case CVR: s->csr &= ~(uint32_t)COUNTFLAG, count = 0; break;
    default: return false;
    }
    restart(m, count);
    return true;
}
