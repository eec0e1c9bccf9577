#include "schedule.h"

#include "exceptions.h"
#include "fault.h"
#include "peripherals.h"
#include "reset.h"

#define MILLION 1000000u /* picoseconds a microsecond, microseconds a second: in such steps 64 bits hold every product */
#define FAR (1ull << 62) /* the distance to the deadline is a signed number */

uint64_t time_of_cycle_ps(const machine *m, uint64_t cycle) {
    const clock_state *clock = &m->device.clock;
    uint64_t left = cycle - clock->base_cycle, time = left / clock->hz;
    for (int step = 0; step < 2; step++) {
        left = left % clock->hz * MILLION;
        time = time * MILLION + left / clock->hz;
    }
    return clock->base_ps + time;
}

uint64_t cycle_of_time(const machine *m, uint64_t time_ps) {
    const clock_state *clock = &m->device.clock;
    if (time_ps == NEVER) return NEVER;
    if (time_ps <= clock->base_ps) return clock->base_cycle;
    const uint64_t after_us = (time_ps - clock->base_ps) / MILLION;
    const uint64_t low = (time_ps - clock->base_ps) % MILLION * clock->hz;
    const uint64_t middle = after_us % MILLION * clock->hz + low / MILLION;
    const bool begun = low % MILLION || middle % MILLION;
    return clock->base_cycle + after_us / MILLION * clock->hz + middle / MILLION + begun;
}

void schedule(machine *m, enum device device, uint64_t cycle) {
    m->device.due[device] = cycle;
    if (cycle < m->deadline) m->deadline = cycle > m->core.now ? cycle : m->core.now;
}

void schedule_ps(machine *m, enum device device, uint64_t time_ps) { schedule(m, device, cycle_of_time(m, time_ps)); }

static uint64_t first_due(const machine *m) {
    uint64_t first = NEVER;
    for (uint32_t i = 0; i < DEVICES; i++)
        if (m->device.due[i] < first) first = m->device.due[i];
    return first;
}

void run_due_devices(machine *m) {
    for (uint32_t i = 0; i < DEVICES; i++)
        if (m->device.due[i] <= m->core.now) {
            m->device.due[i] = NEVER;
            device_event(m, (enum device)i);
        }
}

static uint64_t run_limit(const machine *m) {
    uint64_t by_time = cycle_of_time(m, m->limit_ps);
    return by_time < m->limit_cycle ? by_time : m->limit_cycle;
}

static bool wakes(machine *m) {
    if (exception_wakes(m)) return true;
    if (!m->core.waits_for_event || !m->core.event) return false;
    m->core.event = 0;
    return true;
}

/* Asleep, time jumps to the next thing that can happen. */
static void sleep_on(machine *m, uint64_t limit) {
    uint64_t next = m->in_call ? NEVER : first_due(m);
    if (next > limit) next = limit;
    if (next > m->core.now) m->core.now = next;
}

/* A function that the host calls cannot go through a reset: the call ends there. */
static void answer_reset_request(machine *m) {
    if (m->in_call)
        stop_run(m, STOP_RESET, 0, m->device.reset_request);
    else
        machine_reset(m, m->device.reset_request);
}

bool machine_service(machine *m) {
    for (;;) {
        if (!m->in_call) run_due_devices(m);
        if (m->device.reset_request) answer_reset_request(m);
        uint64_t limit = run_limit(m);
        if (m->core.now >= limit) stop_run(m, STOP_LIMIT, 0, 0);
        if (m->stop.kind != STOP_NONE) return false;
        if (m->core.sleeping && !wakes(m)) {
            sleep_on(m, limit);
            continue;
        }
        m->core.sleeping = 0;
        if (exception_next(m)) {
            exception_enter(m);
            continue;
        }
        uint64_t due = m->in_call ? NEVER : first_due(m);
        m->deadline = due < limit ? due : limit;
        if (m->deadline > m->core.now + FAR) m->deadline = m->core.now + FAR;
        if (m->deadline > m->core.now) return true;
    }
}
