/* One direction of a serial line: frames of ten bits on a time axis, and a receiver that samples them with its own clock. */
#ifndef LINE_H
#define LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Ten levels as they stand on the line: bit 0 is the start bit, 1..8 the data from the lowest, 9 the stop bit. */
typedef struct { uint64_t start_ps, bit_ps; uint16_t levels; } frame;

/* What befalls the bits of bytes sent from now on: each may begin a burst, in which every bit is a throw of a coin. */
typedef struct { uint32_t bursts_per_2_32, burst_bits, burst_left, random; bool stuck; } disturbance;

/* Frames in order of time; those that no receiver can meet again are dropped from the head. */
typedef struct { frame *frames; size_t head, tail, capacity; uint64_t free_ps; disturbance disturbed; } line;

/* `edge_ps` is the falling edge that starts the byte in reception; `search_ps` is where the search for the next one begins. */
typedef struct { bool busy; uint64_t search_ps, edge_ps; } receiver;

typedef struct { uint8_t byte; bool framing_error, noise, false_start; } sampled_byte;

line *line_create(void);
void line_destroy(line *self);
void line_clear(line *self, uint64_t now_ps);

/* Append one byte that starts when the line is free, but not before `earliest_ps`; returns the end of its stop bit. */
uint64_t line_send(line *self, uint8_t byte, uint64_t earliest_ps, uint64_t bit_ps);

/* A line that rests at one level carries nothing; one that falls low shows its receiver a single break. */
void line_stick(line *self, bool low, uint64_t now_ps, uint64_t bit_ps);

/* Look for the next start edge; true when there is one, then `self->edge_ps` holds it. */
bool receiver_find_start(receiver *self, line *from);

/* Sample the ten bits that begin at `edge_ps`, each by a majority of three, and move on. */
sampled_byte receiver_sample(receiver *self, line *from, uint64_t bit_ps);

#endif
