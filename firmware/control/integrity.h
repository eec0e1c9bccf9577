/*
 * A seal over state that rests between two pieces of work: a bit that flips in RAM meanwhile breaks it. A sum finds
 * every single flipped bit at 8 cycles a word, where a CRC-32 takes 80.
 */
#ifndef INTEGRITY_H
#define INTEGRITY_H

#include <stddef.h>
#include <stdint.h>

/* Sum of the words from `from` (aligned to 4 bytes) to before `to`, rotated by one bit before each is added. */
uint32_t integrity_sum(const void *from, const void *to);

#endif
