/* Independent watchdog (RM0444 28): counts LSI cycles of 32 kHz whatever the core does; started, it cannot be stopped. */
#include "fault.h"
#include "peripherals.h"
#include "schedule.h"

enum { KR = 0x00, PR = 0x04, RLR = 0x08, SR = 0x0C, WINR = 0x10 };
enum { START = 0xCCCC, RELOAD = 0xAAAA, UNLOCK = 0x5555 };
enum { PVU = 1, RVU = 2, WVU = 4 };

#define LSI_CYCLE_PS 31250000ull
#define UPDATE_LSI_CYCLES 5u /* a register takes that long to reach the watchdog; SR shows it */

void iwdg_reset(machine *m) {
    m->device.iwdg = (iwdg_state){.rlr = 0xFFF, .from = 0xFFF, .winr = 0xFFF};
    m->device.due[DEV_IWDG] = NEVER;
}

static uint64_t count_ps(const iwdg_state *w) { return LSI_CYCLE_PS * (4ull << (w->pr > 6 ? 6 : w->pr)); }

void iwdg_reschedule(machine *m) {
    const iwdg_state *w = &m->device.iwdg;
    if (w->running) schedule_ps(m, DEV_IWDG, w->reload_ps + (w->from + 1ull) * count_ps(w));
}

void iwdg_bite(machine *m) {
    m->device.reset_request = RESET_WATCHDOG;
    attention(m);
}

static uint32_t busy(const machine *m) { return now_ps(m) < m->device.iwdg.busy_until_ps ? m->device.iwdg.busy : 0; }

static void reload(machine *m) {
    iwdg_state *w = &m->device.iwdg;
    uint64_t counted = (now_ps(m) - w->reload_ps) / count_ps(w);
    bool too_early = w->running && w->winr < w->from && counted < w->from - w->winr;
    if (too_early) return iwdg_bite(m);
    w->reload_ps = now_ps(m);
    w->from = w->rlr; /* RLR counts from a feed on, not from when it is written (28.4.3) */
    iwdg_reschedule(m);
}

static void key(machine *m, uint32_t value) {
    iwdg_state *w = &m->device.iwdg;
    w->unlocked = value == UNLOCK;
    if (value == RELOAD) reload(m);
    if (value == START && !w->running) {
        w->running = true;
        w->reload_ps = now_ps(m);
        iwdg_reschedule(m);
    }
}

bool iwdg_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    const iwdg_state *w = &m->device.iwdg;
    *value = offset == PR ? w->pr : offset == RLR ? w->rlr : offset == SR ? busy(m) : offset == WINR ? w->winr : 0;
    return true;
}

bool iwdg_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)index;
    iwdg_state *w = &m->device.iwdg;
    if (offset == KR) key(m, value);
    if (offset == KR || offset == SR || !w->unlocked) return true;
    w->busy = busy(m) | (offset == PR ? PVU : offset == RLR ? RVU : WVU);
    w->busy_until_ps = now_ps(m) + UPDATE_LSI_CYCLES * LSI_CYCLE_PS;
    if (offset == PR) w->pr = value & 7u;
    if (offset == RLR) w->rlr = value & 0xFFFu;
    if (offset == WINR) w->winr = value & 0xFFFu, reload(m);
    iwdg_reschedule(m);
    return true;
}
