#include "line.h"

#include <stdlib.h>
#include <string.h>

#define FRAME_BITS 10u

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

uint64_t line_send(line *self, uint8_t byte, uint64_t earliest_ps, uint64_t bit_ps) {
    make_room(self);
    uint64_t start = earliest_ps > self->free_ps ? earliest_ps : self->free_ps;
    self->frames[self->tail++] = (frame){.start_ps = start, .bit_ps = bit_ps, .byte = byte};
    self->free_ps = start + FRAME_BITS * bit_ps;
    return self->free_ps;
}

static uint64_t end_of(const frame *f) { return f->start_ps + FRAME_BITS * f->bit_ps; }

/* Bit 0 is the start bit, 1..8 the data from the lowest, 9 the stop bit. */
static uint32_t bit_of(const frame *f, uint64_t index) {
    if (index == 0) return 0;
    return index > 8 ? 1 : (f->byte >> (index - 1)) & 1u;
}

static uint32_t level_at(const line *self, uint64_t time_ps) {
    for (size_t i = self->head; i < self->tail && self->frames[i].start_ps <= time_ps; i++) {
        const frame *f = &self->frames[i];
        if (time_ps < end_of(f)) return bit_of(f, (time_ps - f->start_ps) / f->bit_ps);
    }
    return 1; /* an idle line rests high */
}

static bool falling_edge_in(const frame *f, uint64_t from_ps, uint64_t *edge_ps) {
    for (uint64_t k = 0; k < FRAME_BITS - 1; k++) {
        uint64_t time = f->start_ps + k * f->bit_ps;
        bool falls = bit_of(f, k) == 0 && (k == 0 || bit_of(f, k - 1) == 1);
        if (falls && time >= from_ps) {
            *edge_ps = time;
            return true;
        }
    }
    return false;
}

bool receiver_find_start(receiver *self, line *from) {
    while (from->head < from->tail && end_of(&from->frames[from->head]) <= self->search_ps) from->head++;
    for (size_t i = from->head; i < from->tail; i++)
        if (falling_edge_in(&from->frames[i], self->search_ps, &self->edge_ps)) return true;
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
