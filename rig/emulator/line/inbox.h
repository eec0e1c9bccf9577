/* What the host has received from the board, until it is fetched. */
#ifndef INBOX_H
#define INBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct { uint64_t end_ps; uint8_t byte, framing_error, noise; } received_byte;
typedef struct { received_byte *bytes; size_t head, tail, capacity; } inbox;

inbox *inbox_create(void);
void inbox_destroy(inbox *self);
void inbox_put(inbox *self, received_byte byte);
static inline size_t inbox_count(const inbox *self) { return self->tail - self->head; }
size_t inbox_take(inbox *self, received_byte *out, size_t most);

#endif
