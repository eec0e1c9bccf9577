#include "inbox.h"

#include <stdlib.h>
#include <string.h>

inbox *inbox_create(void) { return calloc(1, sizeof(inbox)); }

void inbox_destroy(inbox *self) {
    free(self->bytes);
    free(self);
}

void inbox_put(inbox *self, received_byte byte) {
    if (self->tail == self->capacity) {
        self->capacity = self->capacity ? 2 * self->capacity : 256;
        self->bytes = realloc(self->bytes, self->capacity * sizeof(received_byte));
    }
    self->bytes[self->tail++] = byte;
}

size_t inbox_take(inbox *self, received_byte *out, size_t most) {
    size_t count = inbox_count(self) < most ? inbox_count(self) : most;
    if (count) memcpy(out, self->bytes + self->head, count * sizeof(received_byte));
    self->head += count;
    if (self->head == self->tail) self->head = self->tail = 0;
    return count;
}
