#include "integrity.h"

typedef uint32_t __attribute__((may_alias)) any_word;

uint32_t integrity_sum(const void *from, const void *to)
{
    uint32_t sum = 0;
    for (const any_word *word = from; word < (const any_word *)to; word++) {
        sum = ((sum << 1) | (sum >> 31)) + *word;
    }
    return sum;
}
