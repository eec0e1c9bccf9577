/*
 * The line: bytes to checked frames and back. No hardware, no time; every frame that was delimited on the line is
 * accepted or counted in exactly one error counter.
 */
#ifndef LINK_H
#define LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol.h"

/* One accepted frame. */
typedef struct {
    uint8_t type;      /* PROTOCOL_TYPE_... */
    uint16_t sequence; /* the host's number of it */
    bool repeated;     /* the same frame as the last accepted one, by number and type */
    uint8_t payload[PROTOCOL_PAYLOAD_MAX];
} link_frame;

/* What has come since the last delimiter; the only part that a byte inside a frame changes. */
typedef struct {
    uint8_t bytes[PROTOCOL_LINE_MAX]; /* encoded */
    size_t length;
    bool overflowed; /* more came than any message needs: dropped up to the next delimiter */
} link_incoming;

typedef struct {
    link_incoming incoming;
    bool in_session; /* a first frame has set the host's sequence number */
    uint8_t last_type;
    uint16_t last_sequence; /* of the last accepted frame */
    uint16_t own_sequence;  /* of the next frame to send */
    protocol_counters counters;
} link_state;

void link_start(link_state *self);

/* Take one byte off the line; true when it completed an accepted frame, which is then in `frame`. */
bool link_receive(link_state *self, uint8_t byte, link_frame *frame);

/* Frame `length` payload bytes as message `type` into `line`; returns the bytes to send, delimiter included. */
size_t link_send(link_state *self, uint8_t type, const uint8_t *payload, size_t length, uint8_t line[PROTOCOL_LINE_MAX]);

/* Frames that were delimited on the line and not accepted. */
uint32_t link_refused(const link_state *self);

#endif
