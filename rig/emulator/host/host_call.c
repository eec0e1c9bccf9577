/* One function of the image, called by the host as the procedure call standard (AAPCS) says.
 *
 * Interrupts are off and peripherals stand still; afterwards core and peripherals are as before. What the function has
 * written to memory stays, and so do the counters of instructions, coverage and stack. */
#include <string.h>

#include "bus.h"
#include "code.h"
#include "fault.h"
#include "host.h"
#include "schedule.h"
#include "special_registers.h"

typedef struct { core_state core; device_state device; } put_aside;

static put_aside begin(machine *m) {
    put_aside kept = {m->core, m->device};
    m->in_call = true;
    m->device.reset_request = 0;
    return kept;
}

static void end(machine *m, const put_aside *kept) {
    m->in_call = false;
    m->core = kept->core;
    m->device = kept->device;
    attention(m);
}

static void enter(machine *m, uint32_t address, const uint32_t *arguments, uint32_t stacked) {
    set_mode(m, 0, 0);
    m->core.primask = 1;
    m->core.active = m->core.pending = 0;
    m->core.sleeping = 0;
    memcpy(m->core.r, arguments, 4 * sizeof(uint32_t));
    m->core.r[13] = (m->core.r[13] - 4u * stacked) & ~7u;
    for (uint32_t i = 0; i < stacked; i++) emulator_write(m, m->core.r[13] + 4u * i, (const uint8_t *)&arguments[4u + i], 4u);
    m->core.r[14] = CALL_RETURN | 1u;
    go_to(m, address | 1u);
}

static call_report call_once(machine *m, uint32_t address, const uint32_t *arguments, uint32_t stacked, uint64_t max_cycles) {
    uint32_t mark = m->count.lowest_sp[MAIN_STACK];
    m->stop = (stop_record){0};
    enter(m, address, arguments, stacked);
    uint32_t sp = m->core.r[13];
    counters before = m->count;
    uint64_t start = m->core.now;
    m->count.lowest_sp[MAIN_STACK] = sp;
    m->limit_ps = NEVER, m->limit_cycle = start + max_cycles;
    attention(m);
    service(RESUME(m));
    call_report report = {.result = m->core.r[0], .stop_kind = m->stop.kind, .stack_bytes = sp - m->count.lowest_sp[MAIN_STACK],
                          .cycles = m->core.now - start, .instructions = m->count.instructions - before.instructions,
                          .flash_stalls = m->count.flash_stalls - before.flash_stalls};
    if (mark < m->count.lowest_sp[MAIN_STACK]) m->count.lowest_sp[MAIN_STACK] = mark;
    return report;
}

void emulator_call(machine *m, uint32_t address, const uint32_t *arguments, uint32_t stacked, uint64_t max_cycles, call_report *out) {
    put_aside kept = begin(m);
    *out = call_once(m, address, arguments, stacked, max_cycles);
    end(m, &kept);
}

static bool copy_in(machine *m, const call_block *blocks, uint32_t count, uint32_t step) {
    for (uint32_t i = 0; i < count; i++)
        if (!emulator_write(m, blocks[i].address, blocks[i].host + (uint64_t)step * blocks[i].bytes, blocks[i].bytes)) return false;
    return true;
}

static bool copy_out(machine *m, const call_block *blocks, uint32_t count, uint32_t step) {
    for (uint32_t i = 0; i < count; i++)
        if (!emulator_read(m, blocks[i].address, blocks[i].host + (uint64_t)step * blocks[i].bytes, blocks[i].bytes)) return false;
    return true;
}

/* Returns the steps done; fewer than asked when one did not return, then `last` says why. */
uint32_t emulator_call_many(machine *m, uint32_t address, const uint32_t *arguments, uint64_t max_cycles, uint32_t steps,
                            const call_block *inputs, uint32_t input_count, const call_block *outputs, uint32_t output_count,
                            uint32_t *results, uint64_t *cycles, call_report *last) {
    put_aside kept = begin(m);
    uint32_t step = 0, stack_bytes = 0;
    uint64_t instructions = 0, flash_stalls = 0;
    for (; step < steps && copy_in(m, inputs, input_count, step); step++) {
        *last = call_once(m, address, arguments, 0, max_cycles);
        if (last->stop_kind != STOP_RETURNED || !copy_out(m, outputs, output_count, step)) break;
        results[step] = last->result, cycles[step] = last->cycles;
        if (last->stack_bytes > stack_bytes) stack_bytes = last->stack_bytes;
        instructions += last->instructions, flash_stalls += last->flash_stalls;
    }
    last->stack_bytes = stack_bytes, last->instructions = instructions, last->flash_stalls = flash_stalls;
    end(m, &kept);
    return step;
}
