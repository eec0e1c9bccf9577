/*
 * Both directions of a line with the firmware's control path at its end: bytes as the host sends them, bit by bit over
 * the emulated line, into the real receiver; what each end heard and what was accepted comes back.
 */
#include <stdlib.h>

#include "line.h"
#include "path.h"
#include "words.h"

#define BIT_PS 1085069u /* 1 / 921 600 Bd */
#define GAP_PS (40u * BIT_PS)

typedef struct {
    uint8_t type;
    uint16_t sequence;
    uint32_t psi_ref_word; /* as the law saw it */
} accepted_frame;

typedef struct {
    path_state path;
    line *to_board, *to_host;
    receiver board, host;
    uint64_t host_bit_ps;
} line_box;

typedef struct {
    size_t heard_by_board, heard_by_host, accepted;
} carried;

line_box *line_box_create(void)
{
    line_box *self = calloc(1, sizeof *self);
    const board_identity identity = {.reset_cause = PROTOCOL_RESET_CAUSE_POWER};
    path_start(&self->path, &identity);
    self->to_board = line_create();
    self->to_host = line_create();
    self->host_bit_ps = BIT_PS;
    return self;
}

void line_box_destroy(line_box *self)
{
    line_destroy(self->to_board);
    line_destroy(self->to_host);
    free(self);
}

void line_box_weather(line_box *self, uint32_t bursts_per_2_32, uint32_t burst_bits, uint32_t seed, uint64_t host_bit_ps)
{
    const disturbance noise = {.bursts_per_2_32 = bursts_per_2_32, .burst_bits = burst_bits, .random = seed};
    self->to_board->disturbed = noise;
    self->to_host->disturbed = noise;
    self->to_host->disturbed.random = ~seed;
    self->host_bit_ps = host_bit_ps;
}

void line_box_stick(line_box *self, uint32_t low)
{
    line_stick(self->to_board, low != 0, self->to_board->free_ps, self->host_bit_ps);
    line_stick(self->to_host, low != 0, self->to_host->free_ps, BIT_PS);
}

static void send_all(line *on, const uint8_t *bytes, size_t count, uint64_t bit_ps)
{
    const uint64_t earliest_ps = on->free_ps + GAP_PS;
    for (size_t i = 0; i < count; i++) {
        line_send(on, bytes[i], earliest_ps, bit_ps);
    }
}

static size_t hear_all(line *on, receiver *by, uint64_t bit_ps, uint8_t *heard)
{
    size_t count = 0;
    while (receiver_find_start(by, on)) {
        const sampled_byte got = receiver_sample(by, on, bit_ps);
        if (!got.false_start) {
            heard[count++] = got.byte;
        }
    }
    return count;
}

static void answer(line_box *self, path_demand demand)
{
    uint8_t reply[PROTOCOL_LINE_MAX];
    if (demand == PATH_STEP) {
        path_law(&self->path);
    }
    path_limits(&self->path);
    send_all(self->to_host, reply, path_reply(&self->path, 0, reply), BIT_PS);
    path_seal(&self->path);
}

carried line_box_carry(
    line_box *self, const uint8_t *sent, size_t count, uint8_t *board_heard, uint8_t *host_heard, accepted_frame *accepted)
{
    carried sums = {0};
    send_all(self->to_board, sent, count, self->host_bit_ps);
    sums.heard_by_board = hear_all(self->to_board, &self->board, BIT_PS, board_heard);
    for (size_t i = 0; i < sums.heard_by_board; i++) {
        const path_demand demand = path_receive(&self->path, board_heard[i]);
        if (demand != PATH_NOTHING) {
            answer(self, demand);
            accepted[sums.accepted++] = (accepted_frame){
                .type = self->path.link.last_type, .sequence = self->path.link.last_sequence,
                .psi_ref_word = word_of_number(self->path.input.psi_ref_rad)};
        }
    }
    sums.heard_by_host = hear_all(self->to_host, &self->host, self->host_bit_ps, host_heard);
    return sums;
}
