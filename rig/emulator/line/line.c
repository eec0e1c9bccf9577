#include "line.h"

#include <stdlib.h>
#include <string.h>

#define FRAME_BITS 10u
#define STOP_BIT 0x200u

line *line_create(void) { return calloc(1, sizeof(line)); }

void line_destroy(line *self) {
    free(self->frames);
    free(self);
}

void line_clear(line *self, uint64_t now_ps) {
    self->head = self->tail = 0;
    self->free_ps = now_ps;
}

static void make_room(line *self) {
    if (self->tail < self->capacity) return;
    if (self->head > self->capacity / 2) {
        memmove(self->frames, self->frames + self->head, (self->tail - self->head) * sizeof(frame));
        self->tail -= self->head;
        self->head = 0;
        return;
    }
    self->capacity = self->capacity ? 2 * self->capacity : 64;
    self->frames = realloc(self->frames, self->capacity * sizeof(frame));
}

static uint32_t next_random(disturbance *d) {
    d->random ^= d->random << 13; /* G. Marsaglia, Xorshift RNGs, J. Stat. Software 8(14), 2003 */
    d->random ^= d->random >> 17;
    d->random ^= d->random << 5;
    return d->random;
}

static uint16_t flips_of_next_byte(disturbance *d) {
    uint16_t flips = 0;
    if (!d->bursts_per_2_32 && !d->burst_left) return 0;
    for (uint32_t k = 0; k < FRAME_BITS; k++) {
        bool begins = next_random(d) < d->bursts_per_2_32;
        bool flipped = begins || (d->burst_left && next_random(d) & 1u);
        d->burst_left = begins ? d->burst_bits - 1 : d->burst_left ? d->burst_left - 1 : 0;
        flips |= (uint16_t)(flipped << k);
    }
    return flips;
}

static void append(line *self, uint64_t start_ps, uint64_t bit_ps, uint16_t levels) {
    make_room(self);
    self->frames[self->tail++] = (frame){.start_ps = start_ps, .bit_ps = bit_ps, .levels = levels};
}

uint64_t line_send(line *self, uint8_t byte, uint64_t earliest_ps, uint64_t bit_ps) {
    uint64_t start = earliest_ps > self->free_ps ? earliest_ps : self->free_ps;
    uint16_t levels = (uint16_t)(STOP_BIT | (uint32_t)byte << 1) ^ flips_of_next_byte(&self->disturbed);
    if (!self->disturbed.stuck) append(self, start, bit_ps, levels);
    self->free_ps = start + FRAME_BITS * bit_ps;
    return self->free_ps;
}

void line_stick(line *self, bool low, uint64_t now_ps, uint64_t bit_ps) {
    uint64_t start = now_ps > self->free_ps ? now_ps : self->free_ps;
    if (low && !self->disturbed.stuck) append(self, start, bit_ps, 0);
    if (low) self->free_ps = start + FRAME_BITS * bit_ps;
    self->disturbed.stuck = true;
}

static uint64_t end_of(const frame *f) { return f->start_ps + FRAME_BITS * f->bit_ps; }

static uint32_t bit_of(const frame *f, uint64_t index) { return (f->levels >> index) & 1u; }

static uint32_t level_at(const line *self, uint64_t time_ps) {
    for (size_t i = self->head; i < self->tail && self->frames[i].start_ps <= time_ps; i++) {
        const frame *f = &self->frames[i];
        if (time_ps < end_of(f)) return bit_of(f, (time_ps - f->start_ps) / f->bit_ps);
    }
    return 1; /* an idle line rests high */
}

/* `before` is the level that the line had when the frame began. */
static bool falling_edge_in(const frame *f, uint32_t before, uint64_t from_ps, uint64_t *edge_ps) {
    for (uint64_t k = 0; k < FRAME_BITS; k++) {
        uint64_t time = f->start_ps + k * f->bit_ps;
        bool falls = bit_of(f, k) == 0 && (k == 0 ? before : bit_of(f, k - 1)) == 1;
        if (falls && time >= from_ps) {
            *edge_ps = time;
            return true;
        }
    }
    return false;
}

bool receiver_find_start(receiver *self, line *from) {
    while (from->head < from->tail && end_of(&from->frames[from->head]) <= self->search_ps) from->head++;
    for (size_t i = from->head; i < from->tail; i++) {
        bool joined = i > from->head && end_of(&from->frames[i - 1]) == from->frames[i].start_ps;
        uint32_t before = joined ? bit_of(&from->frames[i - 1], FRAME_BITS - 1) : 1;
        if (falling_edge_in(&from->frames[i], before, self->search_ps, &self->edge_ps)) return true;
    }
    return false;
}

/* A majority of samples at 7/16, 8/16 and 9/16 of the bit (RM0444 33.5.6); `noise` when they differ. */
static uint32_t sample_bit(const line *from, uint64_t bit_start_ps, uint64_t bit_ps, bool *noise) {
    uint32_t ones = 0;
    for (uint64_t sixteenth = 7; sixteenth <= 9; sixteenth++) ones += level_at(from, bit_start_ps + sixteenth * bit_ps / 16);
    if (ones == 1 || ones == 2) *noise = true;
    return ones >= 2;
}

sampled_byte receiver_sample(receiver *self, line *from, uint64_t bit_ps) {
    sampled_byte got = {0};
    got.false_start = sample_bit(from, self->edge_ps, bit_ps, &got.noise) != 0;
    if (got.false_start) {
        self->search_ps = self->edge_ps + bit_ps / 2;
        return got;
    }
    for (uint32_t k = 1; k <= 8; k++) got.byte |= (uint8_t)(sample_bit(from, self->edge_ps + k * bit_ps, bit_ps, &got.noise) << (k - 1));
    got.framing_error = sample_bit(from, self->edge_ps + 9 * bit_ps, bit_ps, &got.noise) == 0;
    self->search_ps = self->edge_ps + 9 * bit_ps + bit_ps / 2;
    return got;
}
