/*
 * The control path on bytes from a fuzzer, which are read as a small programme: raw bytes, sound frames of any content,
 * control ticks. Whatever it is, the state stays inside its ranges and the next sound frame is answered.
 */
#include <string.h>

#include "cobs.h"
#include "crc32.h"
#include "path.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct {
    const uint8_t *data;
    size_t left;
    size_t pieces; /* delimited ones that are not empty, counted apart from the firmware */
    bool inside;
    uint32_t accepted;
    path_state path;
} run;

static void must(bool truth)
{
    if (!truth) {
        __builtin_trap();
    }
}

static uint8_t next(run *self)
{
    if (self->left == 0u) {
        return 0;
    }
    self->left--;
    return *self->data++;
}

static uint32_t next_word(run *self)
{
    uint32_t word = next(self);
    for (uint32_t i = 1; i < 4u; i++) {
        word |= (uint32_t)next(self) << (8u * i);
    }
    return word;
}

static void finish(run *self, path_demand demand)
{
    must(demand != PATH_BROKEN);
    if (demand == PATH_STEP) {
        path_law(&self->path);
    }
    const motor_duties *duty = path_limits(&self->path);
    const int32_t full = (int32_t)LAW_PWM_TICKS;
    must(duty->main_ticks <= full && duty->main_ticks >= -full && duty->tail_ticks <= full && duty->tail_ticks >= -full);
    must(self->path.supervisor.state <= PROTOCOL_STATE_LOST);
    must(supervisor_is_armed(&self->path.supervisor) || self->path.supervisor.state == PROTOCOL_STATE_RAMPING
         || (duty->main_ticks == 0 && duty->tail_ticks == 0));
}

static bool feed(run *self, uint8_t byte)
{
    uint8_t line[PROTOCOL_LINE_MAX];
    const path_demand demand = path_receive(&self->path, byte);
    self->pieces += byte == 0u && self->inside ? 1u : 0u;
    self->inside = byte != 0u;
    must(self->path.link.incoming.length <= sizeof self->path.link.incoming.bytes);
    if (demand == PATH_NOTHING) {
        return false;
    }
    finish(self, demand);
    must(path_reply(&self->path, 0, line) <= sizeof line);
    path_seal(&self->path);
    return true;
}

static bool feed_frame(run *self, const uint8_t *content, size_t length)
{
    uint8_t checked[64 + 4], line[COBS_ENCODED_MAX(64 + 4)];
    const uint32_t crc = crc32_of(content, length);
    memcpy(checked, content, length);
    for (uint32_t i = 0; i < 4u; i++) {
        checked[length + i] = (uint8_t)(crc >> (8u * i));
    }
    const size_t encoded = cobs_encode(checked, length + 4u, line);
    for (size_t i = 0; i < encoded; i++) {
        (void)feed(self, line[i]);
    }
    return feed(self, COBS_DELIMITER);
}

static void frame_of_input(run *self)
{
    uint8_t content[64] = {PROTOCOL_VERSION};
    const uint8_t kind = next(self);
    content[1] = kind & 15u;
    content[2] = next(self);
    const int32_t expected = protocol_length_to_board(content[1]);
    const size_t length = kind & 128u || expected < 0 ? next(self) & 31u : (size_t)expected;
    for (size_t i = 0; i < length; i++) {
        content[4u + i] = next(self);
    }
    if (kind & 64u) { /* the table that the board carries, so that arming succeeds */
        memcpy(content + 5, LAW_TABLE_DIGEST, 8);
    }
    (void)feed_frame(self, content, 4u + length);
}

static void tick_of_input(run *self)
{
    uint8_t line[PROTOCOL_LINE_MAX];
    const uint8_t kind = next(self);
    encoder_counts counts = self->path.watch.last;
    if (kind & 128u) {
        counts = (encoder_counts){(int32_t)next_word(self), (int32_t)next_word(self)};
    }
    finish(self, path_tick(&self->path, &counts, kind & 64u ? next_word(self) : 1u));
    must(path_telemetry(&self->path, 0, line) <= sizeof line);
    path_seal(&self->path);
}

static void is_not_stuck(run *self)
{
    const uint8_t identify[4] = {PROTOCOL_VERSION, PROTOCOL_TYPE_IDENTIFY, 77, 0};
    const protocol_counters *c = &self->path.link.counters;
    (void)feed(self, COBS_DELIMITER);
    must(c->frames_accepted + link_refused(&self->path.link) == self->pieces);
    must(feed_frame(self, identify, sizeof identify) && self->path.reply_type == PROTOCOL_TYPE_IDENTITY);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const board_identity identity;
    run self = {.data = data, .left = size};
    path_start(&self.path, &identity);
    while (self.left > 0u) {
        const uint8_t what = next(&self);
        if (what < 64u) {
            tick_of_input(&self);
        } else if (what < 192u) {
            frame_of_input(&self);
        } else {
            for (uint32_t i = what & 63u; i > 0u; i--) {
                (void)feed(&self, next(&self));
            }
        }
    }
    is_not_stuck(&self);
    return 0;
}
