#include "link.h"

#include "cobs.h"
#include "crc32.h"

#define TYPE_AT 1u
#define SEQUENCE_AT 2u
#define FRAME_MIN (PROTOCOL_HEADER_SIZE + PROTOCOL_CRC_SIZE)

static uint16_t read_u16(const uint8_t *from)
{
    return (uint16_t)(from[0] | ((uint32_t)from[1] << 8));
}

static uint32_t read_u32(const uint8_t *from)
{
    return read_u16(from) | ((uint32_t)read_u16(from + 2) << 16);
}

static void write_u32(uint8_t *to, uint32_t value)
{
    for (uint32_t i = 0; i < 4u; i++) {
        to[i] = (uint8_t)((value >> (8u * i)) & 0xffu);
    }
}

void link_start(link_state *self)
{
    *self = (link_state){0};
}

/* The counter of what is wrong with the bytes of a decoded frame, or NULL; the CRC is judged before any field is. */
static uint32_t *fault_of_bytes(protocol_counters *counters, const uint8_t *frame, size_t length)
{
    if (length == COBS_INVALID) {
        return &counters->cobs_errors;
    }
    if (length < FRAME_MIN) {
        return &counters->too_short;
    }
    if (crc32_of(frame, length - PROTOCOL_CRC_SIZE) != read_u32(frame + length - PROTOCOL_CRC_SIZE)) {
        return &counters->crc_errors;
    }
    if (frame[0] != PROTOCOL_VERSION) {
        return &counters->wrong_version;
    }
    const int32_t expected = protocol_length_to_board(frame[TYPE_AT]);
    if (expected < 0) {
        return &counters->unknown_type;
    }
    return length - FRAME_MIN == (size_t)expected ? NULL : &counters->wrong_length;
}

/*
 * Judge the sequence number; false for a frame from the past. IDENTIFY opens a session whatever its number. DISARM is
 * obeyed whatever its number, because a host that lost count must still be able to stop the rotors.
 */
static bool follows(link_state *self, link_frame *frame)
{
    const uint16_t ahead = (uint16_t)(frame->sequence - self->last_sequence);
    frame->repeated = self->in_session && ahead == 0u && frame->type == self->last_type;
    if (frame->repeated) {
        self->counters.repeated++;
    } else if (self->in_session && frame->type != PROTOCOL_TYPE_IDENTIFY) {
        if (ahead == 0u || ahead >= 0x8000u) {
            const bool obeyed = frame->type == PROTOCOL_TYPE_DISARM;
            self->counters.stale += obeyed ? 0u : 1u;
            return obeyed;
        }
        self->counters.frames_lost += (uint32_t)ahead - 1u;
    }
    self->in_session = true;
    self->last_sequence = frame->sequence;
    self->last_type = frame->type;
    return true;
}

static bool accept(link_state *self, size_t encoded_length, link_frame *frame)
{
    uint8_t *bytes = self->incoming.bytes;
    const size_t length = cobs_decode(bytes, encoded_length, bytes);
    uint32_t *fault = fault_of_bytes(&self->counters, bytes, length);
    if (fault != NULL) {
        (*fault)++;
        return false;
    }
    frame->type = bytes[TYPE_AT];
    frame->sequence = read_u16(bytes + SEQUENCE_AT);
    for (size_t i = 0; i < length - FRAME_MIN; i++) {
        frame->payload[i] = bytes[PROTOCOL_HEADER_SIZE + i];
    }
    if (!follows(self, frame)) {
        return false;
    }
    self->counters.frames_accepted++;
    return true;
}

bool link_receive(link_state *self, uint8_t byte, link_frame *frame)
{
    link_incoming *incoming = &self->incoming;
    if (byte != COBS_DELIMITER) {
        if (incoming->length < sizeof incoming->bytes) {
            incoming->bytes[incoming->length++] = byte;
        } else {
            incoming->overflowed = true;
        }
        return false;
    }
    const size_t length = incoming->length;
    const bool overflowed = incoming->overflowed;
    incoming->length = 0;
    incoming->overflowed = false;
    if (overflowed || length > sizeof incoming->bytes) {
        self->counters.too_long++;
        return false;
    }
    return length > 0u && accept(self, length, frame);
}

size_t link_send(link_state *self, uint8_t type, const uint8_t *payload, size_t length, uint8_t line[PROTOCOL_LINE_MAX])
{
    uint8_t frame[PROTOCOL_FRAME_MAX];
    frame[0] = PROTOCOL_VERSION;
    frame[TYPE_AT] = type;
    frame[SEQUENCE_AT] = (uint8_t)(self->own_sequence & 0xffu);
    frame[SEQUENCE_AT + 1u] = (uint8_t)(self->own_sequence >> 8);
    self->own_sequence++;
    for (size_t i = 0; i < length; i++) {
        frame[PROTOCOL_HEADER_SIZE + i] = payload[i];
    }
    const size_t covered = PROTOCOL_HEADER_SIZE + length;
    write_u32(frame + covered, crc32_of(frame, covered));
    const size_t encoded = cobs_encode(frame, covered + PROTOCOL_CRC_SIZE, line);
    line[encoded] = COBS_DELIMITER;
    return encoded + 1u;
}

uint32_t link_refused(const link_state *self)
{
    const protocol_counters *c = &self->counters;
    return c->cobs_errors + c->too_long + c->too_short + c->crc_errors + c->wrong_version + c->unknown_type
           + c->wrong_length + c->stale;
}
