#include "cobs.h"

#define FULL_BLOCK 0xffu /* 254 data bytes without an implied zero after them */

size_t cobs_encode(const uint8_t *from, size_t length, uint8_t *to)
{
    size_t code_at = 0;
    size_t at = 1;
    uint8_t code = 1;
    for (size_t i = 0; i < length; i++) {
        if (from[i] != 0u) {
            to[at++] = from[i];
            code++;
        }
        /* A full block at the very end needs no successor: it implies no zero. */
        if (from[i] == 0u || (code == FULL_BLOCK && i + 1u < length)) {
            to[code_at] = code;
            code_at = at++;
            code = 1;
        }
    }
    to[code_at] = code;
    return at;
}

size_t cobs_decode(const uint8_t *from, size_t length, uint8_t *to)
{
    size_t read = 0;
    size_t written = 0;
    if (length == 0u) {
        return COBS_INVALID;
    }
    while (read < length) {
        const uint8_t code = from[read++];
        if (code == 0u || (size_t)(code - 1u) > length - read) {
            return COBS_INVALID;
        }
        for (uint32_t i = 1; i < code; i++) {
            if (from[read] == 0u) {
                return COBS_INVALID;
            }
            to[written++] = from[read++];
        }
        if (code != FULL_BLOCK && read < length) {
            to[written++] = 0;
        }
    }
    return written;
}
