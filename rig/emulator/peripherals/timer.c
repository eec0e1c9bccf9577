/* Timers TIM1, TIM2, TIM3, TIM6, TIM7 (RM0444 22.4, 23.4, 26.4): up-counting, PWM compare values, encoder inputs.
 *
 * A running counter is computed when somebody looks. Only an update interrupt, or one-pulse mode, needs an event. */
#include "exceptions.h"
#include "peripherals.h"
#include "schedule.h"

enum { CR1 = 0, SMCR = 2, DIER = 3, SR = 4, EGR = 5, CNT = 9, PSC = 10, ARR = 11, RCR = 12 }; /* word offsets */
enum { CEN = 1, UDIS = 2, URS = 4, OPM = 8, DIR = 0x10, CMS = 0x60, ARPE = 0x80 };
enum { UIF = 1, UIE = 1, UG = 1 };

static const uint32_t TIMER_IRQ[] = {13, 15, 16, 17, 18}; /* TIM1 break/update, TIM2, TIM3, TIM6, TIM7 */
enum { TIM2_INDEX = 1, TIM6_INDEX = 3 };

static uint32_t mask_of(uint32_t index) { return index == TIM2_INDEX ? 0xFFFFFFFFu : 0xFFFFu; }

void timers_reset(machine *m) {
    for (uint32_t i = 0; i < 5; i++) {
        m->device.timer[i] = (timer_state){.reload = mask_of(i)};
        m->device.timer[i].reg[ARR] = mask_of(i);
        m->device.due[DEV_TIM1 + i] = NEVER;
    }
}

static bool encoder_mode(const timer_state *t) {
    uint32_t mode = t->reg[SMCR] & 7u;
    return mode >= 1 && mode <= 3;
}

static bool counts(const timer_state *t) { return t->reg[CR1] & CEN && !encoder_mode(t) && t->reload != 0; }

static uint64_t cycles_per_count(const machine *m, const timer_state *t) {
    return (t->prescaler + 1ull) * m->device.clock.timer_divider;
}

static void update_line(machine *m, uint32_t index) {
    const timer_state *t = &m->device.timer[index];
    interrupt_line(m, TIMER_IRQ[index], t->reg[SR] & t->reg[DIER] & UIF);
}

static uint64_t counts_to_wrap(const timer_state *t) {
    return t->counter <= t->reload ? t->reload - t->counter + 1ull : (1ull << 32) - t->counter;
}

/* At the update event the buffered PSC and ARR come into force. */
static void update_event(timer_state *t) {
    if (t->reg[CR1] & UDIS) return;
    t->prescaler = t->reg[PSC];
    t->reload = t->reg[ARR];
}

static void wrap_once(machine *m, timer_state *t) {
    t->base_cycle += counts_to_wrap(t) * cycles_per_count(m, t);
    t->counter = 0;
    if (!(t->reg[CR1] & UDIS)) t->reg[SR] |= UIF;
    if (t->reg[CR1] & OPM) t->reg[CR1] &= ~(uint32_t)CEN;
    update_event(t);
}

/* Bring the counter to the present. Many wraps at once are skipped over when nothing can change at them. */
static void advance(machine *m, timer_state *t) {
    uint64_t per_count = cycles_per_count(m, t), elapsed = m->core.now - t->base_cycle;
    if (!counts(t)) {
        t->base_cycle = m->core.now;
        return;
    }
    if (elapsed / per_count >= counts_to_wrap(t)) {
        wrap_once(m, t);
        if (!counts(t)) return advance(m, t);
        per_count = cycles_per_count(m, t), elapsed = m->core.now - t->base_cycle;
        uint64_t period = per_count * (t->reload + 1ull);
        t->base_cycle += elapsed / period * period;
        elapsed %= period;
    }
    uint64_t steps = elapsed / per_count;
    t->counter += (uint32_t)steps;
    t->base_cycle += steps * per_count;
}

static void plan(machine *m, uint32_t index) {
    const timer_state *t = &m->device.timer[index];
    bool needed = counts(t) && (t->reg[DIER] & UIE || t->reg[CR1] & OPM);
    uint64_t wrap = t->base_cycle + counts_to_wrap(t) * cycles_per_count(m, t);
    schedule(m, (enum device)(DEV_TIM1 + index), needed ? wrap : NEVER);
}

void timer_event(machine *m, uint32_t index) {
    advance(m, &m->device.timer[index]);
    update_line(m, index);
    plan(m, index);
}

bool timer_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    timer_state *t = &m->device.timer[index];
    advance(m, t);
    *value = offset / 4 == CNT ? t->counter : offset / 4 == EGR ? 0 : t->reg[offset / 4];
    return true;
}

static void generate_update(machine *m, timer_state *t) {
    t->counter = 0;
    t->base_cycle = m->core.now;
    if (!(t->reg[CR1] & (UDIS | URS))) t->reg[SR] |= UIF;
    update_event(t);
}

/* Down-counting, centre-aligned counting, DMA, capture/compare interrupts and other slave modes are not modelled. */
static bool modelled(uint32_t word, uint32_t value) {
    if (word == CR1) return !(value & CMS);
    if (word == DIER) return !(value & ~(uint32_t)UIE);
    if (word == SMCR) return !(value & 0x10000u) && (value & 7u) <= 3;
    return word != RCR || value == 0;
}

static void store(machine *m, timer_state *t, uint32_t word, uint32_t value, uint32_t mask) {
    t->reg[word] = value;
    if (word == SR || word == EGR) t->reg[word] = 0;
    if (word == CNT) t->counter = value & mask, t->base_cycle = m->core.now;
    if (word == ARR) t->reg[ARR] = value & mask;
    if (word == ARR && !(t->reg[CR1] & ARPE)) t->reload = value & mask;
    if (word == EGR && value & UG) generate_update(m, t);
}

bool timer_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    timer_state *t = &m->device.timer[index];
    uint32_t word = offset / 4;
    advance(m, t);
    if (!modelled(word, value)) return false;
    uint32_t flags = t->reg[SR];
    store(m, t, word, value, mask_of(index));
    if (word == SR) t->reg[SR] = flags & value; /* flags are cleared by writing 0 */
    update_line(m, index);
    plan(m, index);
    return true;
}

/* The encoder interface has counted to `counts` modulo ARR + 1 (RM0444 22.3.24); DIR shows the last direction. */
void timer_set_encoder(machine *m, uint32_t index, int64_t counts) {
    timer_state *t = &m->device.timer[index];
    int64_t period = (int64_t)t->reload + 1, remainder = counts % period;
    if (counts != t->host_counts) t->reg[CR1] = (t->reg[CR1] & ~(uint32_t)DIR) | (counts < t->host_counts ? DIR : 0);
    t->counter = (uint32_t)(remainder < 0 ? remainder + period : remainder);
    t->base_cycle = m->core.now;
    t->host_counts = counts;
}
