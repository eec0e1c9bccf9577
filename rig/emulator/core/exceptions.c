#include "exceptions.h"

#include "bus.h"
#include "code.h"
#include "fault.h"
#include "schedule.h"
#include "special_registers.h"
#include "stack_guard.h"

#define THREAD_PRIORITY 256
#define BIT(number) (1ull << (number))

/* DDI0484C gives 15 cycles from request to first instruction. No source gives return and tail-chaining: the return is
 * charged like the entry, and a chain saves the 16 bus cycles of popping and pushing the frame of 8 words. */
enum { ENTRY_CYCLES = 15, RETURN_CYCLES = 15, CHAIN_CYCLES = ENTRY_CYCLES + RETURN_CYCLES - 16 };
enum { FRAME_WORDS = 8, FRAME_BYTES = 4 * FRAME_WORDS };
#define FRAME_ALIGNED (1u << 9) /* xPSR bit 9: a word of padding lies above the frame */
#define THUMB_STATE (1u << 24)

static int32_t priority_of(const machine *m, uint32_t number) {
    if (number == NMI) return -2;
    return number == HARD_FAULT ? HARD_FAULT_PRIORITY : m->core.priority[number];
}

static int32_t active_priority(const machine *m) {
    int32_t best = THREAD_PRIORITY;
    for (uint64_t rest = m->core.active; rest; rest &= rest - 1) {
        int32_t priority = priority_of(m, (uint32_t)__builtin_ctzll(rest));
        if (priority < best) best = priority;
    }
    return best;
}

int32_t execution_priority(const machine *m) {
    int32_t active = active_priority(m);
    return m->core.primask && active > 0 ? 0 : active;
}

/* Among equals the lower exception number wins (B1.5.4). */
static uint32_t most_urgent(const machine *m, int32_t below) {
    uint64_t candidates = m->core.pending & ((uint64_t)m->core.irq_enabled << FIRST_IRQ | (BIT(FIRST_IRQ) - 1));
    uint32_t best = 0;
    for (uint64_t rest = candidates; rest; rest &= rest - 1) {
        uint32_t number = (uint32_t)__builtin_ctzll(rest);
        if (priority_of(m, number) >= below) continue;
        best = number;
        below = priority_of(m, number);
    }
    return best;
}

uint32_t exception_next(const machine *m) { return m->core.pending ? most_urgent(m, execution_priority(m)) : 0; }

uint32_t exception_waiting(const machine *m) { return most_urgent(m, THREAD_PRIORITY); }

bool exception_wakes(const machine *m) { return m->core.pending && most_urgent(m, active_priority(m)) != 0; }

void exception_pend(machine *m, uint32_t number) {
    bool send_event = m->core.scr & 16u && !(m->core.pending & BIT(number)); /* SCR.SEVONPEND */
    m->core.pending |= BIT(number);
    if (send_event) m->core.event = 1;
    attention(m);
}

void interrupt_line(machine *m, uint32_t irq, bool level) {
    uint32_t bit = 1u << irq;
    bool rises = level && !(m->core.irq_lines & bit);
    m->core.irq_lines = level ? m->core.irq_lines | bit : m->core.irq_lines & ~bit;
    if (rises) exception_pend(m, FIRST_IRQ + irq);
}

static uint32_t *frame_at(machine *m, uint32_t address) {
    bool inside = address - SRAM_BASE <= SRAM_BYTES - FRAME_BYTES && !(address & 3u);
    return inside ? (uint32_t *)(m->sram + (address - SRAM_BASE)) : NULL;
}

/* Where a frame cannot be written or read there is no way on: the core locks up. */
static void frame_fault(machine *m, enum stop_kind kind, uint32_t address) {
    stop_run(m, m->stop_on_fault ? kind : STOP_LOCKUP, address, kind);
}

/* Push r0-r3, r12, lr, return address, xPSR on the stack in use, aligned to 8 bytes (B1.5.6). */
static bool push_frame(machine *m) {
    core_state *core = &m->core;
    uint32_t sp = core->r[13], frame = (sp - FRAME_BYTES) & ~7u;
    uint32_t *word = frame_at(m, frame);
    bool allowed = stack_reaches(m, stack_in_use(m), frame);
    if (!word || !allowed) {
        frame_fault(m, allowed ? STOP_UNMAPPED : STOP_STACK_LIMIT, frame);
        return false;
    }
    for (uint32_t i = 0; i < 4; i++) word[i] = core->r[i];
    word[4] = core->r[12], word[5] = core->r[14], word[6] = pc_of(m, core->ip);
    word[7] = flags_of(m) | THUMB_STATE | core->ipsr | (sp & 4u ? FRAME_ALIGNED : 0);
    core->r[13] = frame;
    return true;
}

static uint32_t exc_return_now(const machine *m) {
    if (m->core.ipsr) return 0xFFFFFFF1u;
    return m->core.control & 2u ? 0xFFFFFFFDu : 0xFFFFFFF9u;
}

/* Start the handler of `number`; the frame is on the stack and lr holds `exc_return`. */
static void start_handler(machine *m, uint32_t number, uint32_t exc_return) {
    set_mode(m, number, m->core.control & ~2u);
    m->core.r[14] = exc_return;
    m->core.pending &= ~BIT(number);
    m->core.active |= BIT(number);
    m->core.event = 1;
    m->count.exceptions[number]++;
    m->count.flash_stalls += 2; /* vector and first instruction */
    const uint8_t *vector = bus_memory(m, m->core.vtor + 4 * number, 4);
    if (!vector) return frame_fault(m, STOP_UNMAPPED, m->core.vtor + 4 * number);
    go_to(m, vector[0] | (uint32_t)vector[1] << 8 | (uint32_t)vector[2] << 16 | (uint32_t)vector[3] << 24);
}

/* Late arrival: what became pending while the frame was pushed may be more urgent and is taken first. */
void exception_enter(machine *m) {
    uint32_t exc_return = exc_return_now(m);
    if (!push_frame(m)) return;
    m->core.now += ENTRY_CYCLES;
    if (!m->in_call) run_due_devices(m);
    start_handler(m, exception_next(m), exc_return);
}

static void deactivate(machine *m) {
    uint32_t number = m->core.ipsr;
    m->core.active &= ~BIT(number);
    m->core.event = 1;
    /* A request line that is still up asks again. */
    if (number >= FIRST_IRQ && m->core.irq_lines >> (number - FIRST_IRQ) & 1u) m->core.pending |= BIT(number);
}

static bool legal_return(const machine *m, uint32_t exc_return) {
    bool nested = (m->core.active & (m->core.active - 1)) != 0;
    if (!(m->core.active & BIT(m->core.ipsr))) return false;
    return exc_return == 0xFFFFFFF1u ? nested : (exc_return == 0xFFFFFFF9u || exc_return == 0xFFFFFFFDu) && !nested;
}

static void pop_frame(machine *m, uint32_t exc_return) {
    core_state *core = &m->core;
    bool process = exc_return == 0xFFFFFFFDu;
    uint32_t frame = process ? core->other_sp : core->r[13];
    const uint32_t *word = frame_at(m, frame);
    if (!word) return frame_fault(m, STOP_UNMAPPED, frame);
    for (uint32_t i = 0; i < 4; i++) core->r[i] = word[i];
    core->r[12] = word[4], core->r[14] = word[5];
    set_flags(m, word[7]);
    *(process ? &core->other_sp : &core->r[13]) = (frame + FRAME_BYTES) | (word[7] & FRAME_ALIGNED ? 4u : 0);
    bool to_thread = exc_return != 0xFFFFFFF1u;
    set_mode(m, to_thread ? 0 : word[7] & 0x3Fu, (core->control & 1u) | (process ? 2u : 0));
    go_to(m, word[6] | (word[7] & THUMB_STATE ? 1u : 0));
}

void exception_return(machine *m, uint32_t exc_return) {
    if (!legal_return(m, exc_return)) return fault(m, STOP_BAD_RETURN, exc_return, 0);
    deactivate(m);
    uint32_t chained = exception_next(m);
    if (chained) {
        m->core.now += CHAIN_CYCLES;
        if (!m->in_call) run_due_devices(m);
        return start_handler(m, exception_next(m), exc_return);
    }
    pop_frame(m, exc_return);
    m->core.now += RETURN_CYCLES;
    bool sleep_on_exit = m->core.scr & 2u && exc_return != 0xFFFFFFF1u;
    if (sleep_on_exit) m->core.sleeping = 1, m->core.waits_for_event = 0;
}
