/* The firmware's receiver alone: bytes in, accepted frames and counters out. */
#include <string.h>

#include "link.h"

typedef struct {
    uint8_t type, repeated;
    uint16_t sequence;
    uint8_t payload[PROTOCOL_PAYLOAD_MAX];
} taken_frame;

size_t link_box_size(void)
{
    return sizeof(link_state);
}

size_t link_box_payload_room(void)
{
    return PROTOCOL_PAYLOAD_MAX;
}

size_t link_box_feed(link_state *self, const uint8_t *data, size_t count, taken_frame *out)
{
    size_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        link_frame frame = {0};
        if (link_receive(self, data[i], &frame)) {
            out[taken] = (taken_frame){.type = frame.type, .repeated = frame.repeated, .sequence = frame.sequence};
            memcpy(out[taken].payload, frame.payload, sizeof frame.payload);
            taken++;
        }
    }
    return taken;
}

void link_box_counters(const link_state *self, uint32_t out[11])
{
    const protocol_counters *c = &self->counters;
    const uint32_t all[11] = {c->frames_accepted, c->cobs_errors, c->too_long, c->too_short, c->crc_errors,
                              c->wrong_version, c->unknown_type, c->wrong_length, c->stale, c->repeated, c->frames_lost};
    memcpy(out, all, sizeof all);
}
